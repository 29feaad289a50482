/** Thumbnails of scans, drawn point by point: a list of scans needs no WebGL. */
import { Vector3 } from "three";

import { distanceToSee, frameOf } from "../view/frame.js";

// The tangent of half the field of view.
const kUp = 0.36;
// The share of the points that may lie outside the picture.
const kStray = 0.02;
// The side of the square that a point covers, so that a surface is closed [pixel].
const kSplat = 2;
// The direction to the light: to the right, up, and to the eye.
const kLight = new Vector3(-0.45, 0.6, 0.65).normalize();
// A surface stands out if it faces this far away from most others, which are a table or a wall.
const kStandsOut = Math.cos((25 * Math.PI) / 180);
// The border of a scan always stands out and is ignored [pixel].
const kBorder = 3;
// With fewer pixels that stand out, the whole scan is shown.
const kMinStanding = 20;
// The share of what stands out that lies beyond each side of its middle.
const kOutside = 0.1;
// The size of the window, in sizes of that middle.
const kRoom = 2.2;
// Beyond this zoom, too few points are left.
const kMaxZoom = 4;

const finite = (value) => (Number.isFinite(value) ? value : 0);
const normalOf = (x, y) => new Vector3(finite(x), finite(y), 1).normalize();

function quantile(values, share) {
  const sorted = Float32Array.from(values).sort();
  return sorted[Math.round(share * (sorted.length - 1))];
}

const median = (values) => quantile(values, 0.5);

/** Points in the image of a camera: [x, y, depth] of each, x and y in -1 to 1 within the view. */
function seenFrom(positions, viewpoint, aspect) {
  const { sample, toWorld, direction } = frameOf(positions, viewpoint);
  const tangents = { across: kUp * aspect, up: kUp };
  const distance = distanceToSee(sample, direction, tangents, kStray);
  const right = new Vector3().crossVectors(new Vector3(0, 1, 0), direction).normalize();
  const above = new Vector3().crossVectors(direction, right);
  const seen = new Float32Array(positions.length);
  const point = new Vector3();
  for (let i = 0; i < positions.length; i += 3) {
    point.fromArray(positions, i).applyMatrix4(toWorld);
    const depth = distance - point.dot(direction);
    seen[i] = point.dot(right) / depth / tangents.across;
    seen[i + 1] = -point.dot(above) / depth / tangents.up;
    seen[i + 2] = depth;
  }
  return seen;
}

/** The nearest depth in each pixel of a window { x, y: of its center, zoom }; infinite: none. */
function depthImage(seen, { width, height }, { x, y, zoom }) {
  const depths = new Float32Array(width * height).fill(Infinity);
  for (let i = 0; i < seen.length; i += 3) {
    const left = Math.round((1 + (seen[i] - x) * zoom) * (width / 2) - kSplat / 2);
    const top = Math.round((1 + (seen[i + 1] - y) * zoom) * (height / 2) - kSplat / 2);
    for (let row = Math.max(0, top); row < Math.min(height, top + kSplat); ++row) {
      for (let column = Math.max(0, left); column < Math.min(width, left + kSplat); ++column) {
        const at = row * width + column;
        if (seen[i + 2] > 0 && seen[i + 2] < depths[at]) depths[at] = seen[i + 2];
      }
    }
  }
  return depths;
}

/**
 * The slopes of a depth image to the right and up: [[at, x, y]], not finite next to empty pixels.
 */
function slopesOf(depths, { width, height }, zoom) {
  const slopes = [];
  depths.forEach((depth, at) => {
    if (depth === Infinity) return;
    const step = (2 * kUp * depth) / height / zoom;
    const rise = (one, other) => (depths[other] - depths[one]) / (2 * step);
    const isInside = at % width > 0 && at % width < width - 1;
    slopes.push([at, isInside ? rise(at - 1, at + 1) : NaN, rise(at + width, at - width)]);
  });
  return slopes;
}

/**
 * Returns a test of whether x lies well between the first and the last of the pixels [x, y] of row
 *   y.
 */
function withinBorder(pixels) {
  const lines = new Map();
  for (const [x, y] of pixels) {
    const [first, last] = lines.get(y) ?? [x, x];
    lines.set(y, [Math.min(first, x), Math.max(last, x)]);
  }
  return (x, y) => x >= lines.get(y)[0] + kBorder && x <= lines.get(y)[1] - kBorder;
}

/** The window around the objects in front of a plain background, or the whole image. */
function windowOf(slopes, { width, height }) {
  const whole = { x: 0, y: 0, zoom: 1 };
  const most = (k) => median(slopes.map((slope) => finite(slope[k])));
  const plain = normalOf(most(1), most(2));
  // A scan also stands out at its border.
  const known = slopes.map(([at]) => [at % width, Math.floor(at / width)]);
  const isInRows = withinBorder(known);
  const isInColumns = withinBorder(known.map(([x, y]) => [y, x]));
  const isInside = (at) => {
    const [x, y] = [at % width, Math.floor(at / width)];
    return isInRows(x, y) && isInColumns(y, x);
  };
  const standing = slopes.filter(
    ([at, x, y]) => isInside(at) && normalOf(x, y).dot(plain) < kStandsOut,
  );
  if (standing.length < kMinStanding) return whole;
  const range = (places) => [kOutside, 1 - kOutside].map((share) => quantile(places, share));
  const [left, right] = range(standing.map(([at]) => (2 * (at % width)) / width - 1));
  const [top, bottom] = range(standing.map(([at]) => (2 * Math.floor(at / width)) / height - 1));
  const zoom = Math.min(kMaxZoom, 2 / kRoom / Math.max(right - left, bottom - top, 1e-3));
  return zoom > 1 ? { x: (left + right) / 2, y: (top + bottom) / 2, zoom } : whole;
}

/**
 * Draws the objects of a scan as in the initial view, shaded by their relief.
 *
 * canvas     keeps its size
 * positions  x, y, z of each point
 * viewpoint  of the sensor, in the same frame
 * color      [r, g, b] of surfaces that face the light
 */
export function drawThumbnail(canvas, positions, viewpoint, color) {
  const context = canvas.getContext("2d");
  context.clearRect(0, 0, canvas.width, canvas.height);
  if (!positions.length) return;
  const seen = seenFrom(positions, viewpoint, canvas.width / canvas.height);
  const whole = { x: 0, y: 0, zoom: 1 };
  const coarse = slopesOf(depthImage(seen, canvas, whole), canvas, 1);
  if (!coarse.length) return;
  const shown = windowOf(coarse, canvas);
  const image = context.createImageData(canvas.width, canvas.height);
  for (const [at, x, y] of slopesOf(depthImage(seen, canvas, shown), canvas, shown.zoom)) {
    const shade = 0.35 + 0.75 * Math.max(0, normalOf(x, y).dot(kLight));
    image.data.set([...color.map((channel) => channel * shade), 255], 4 * at);
  }
  context.putImageData(image, 0, 0);
}

import { BufferAttribute, BufferGeometry, Matrix4, Points, ShaderMaterial } from "three";

import { PaletteTexture } from "./palettes.js";

const kProbes = 40;
// A point has this many neighbors within 1.4 spacings, among random points and in a grid.
const kNeighbors = 6;
// Neighboring points overlap, so that a surface looks closed.
const kSizeInSpacings = "2.0";
// This share of a color that stands for a value is not shaded.
const kUnlit = "0.7";
// A missing value is a float, as GPUs do not agree on NaN.
const kNoValue = 1e30;
// Points are drawn this far behind their places, in radii of the scan: models stand out from them.
const kBehind = 0.006;

/** The spacing of points where they are rather sparse. */
function spacing(positions) {
  const num = positions.length / 3;
  const distances = [];
  for (let probe = 0; probe < Math.min(kProbes, num); ++probe) {
    const i = 3 * Math.floor(((probe + 0.5) * num) / Math.min(kProbes, num));
    // The distances rise, and the first is that of the point itself.
    const nearest = new Array(kNeighbors + 1).fill(Infinity);
    for (let k = 0; k < positions.length; k += 3) {
      const x = positions[k] - positions[i];
      if (x * x >= nearest[kNeighbors]) continue;
      const y = positions[k + 1] - positions[i + 1];
      const z = positions[k + 2] - positions[i + 2];
      const squared = x * x + y * y + z * z;
      if (squared >= nearest[kNeighbors]) continue;
      let at = kNeighbors;
      for (; at > 0 && nearest[at - 1] > squared; --at) nearest[at] = nearest[at - 1];
      nearest[at] = squared;
    }
    if (nearest[kNeighbors] < Infinity) distances.push(Math.sqrt(nearest[kNeighbors]) / 1.4);
  }
  distances.sort((a, b) => a - b);
  return distances[Math.floor(distances.length * 0.8)] ?? 0;
}

const kVertexShader = `
  #include <clipping_planes_pars_vertex>
  attribute float value;
  uniform vec3 color, dim;
  uniform float spacing, pixelsPerUnit, smallest, low, high;
  uniform bool hasValues;
  uniform sampler2D palette;
  varying float seenZ, size;
  // The picture lights the color, as far as its alpha is not 1.
  varying vec4 ink;

  // All texels but the first and the last are for values within the limits.
  vec4 colorOf(float value) {
    if (value > 0.5 * ${kNoValue.toExponential()}) return vec4(dim, ${kUnlit});
    float texels = float(textureSize(palette, 0).x);
    float at = 1.0 + (value - low) / (high - low) * (texels - 2.0);
    float texel = clamp(at, 1.0, texels - 2.0);
    if (value < low) texel = 0.0;
    if (value > high) texel = texels - 1.0;
    return vec4(texelFetch(palette, ivec2(int(texel), 0), 0).rgb, ${kUnlit});
  }

  void main() {
    vec4 mvPosition = modelViewMatrix * vec4(position, 1.0);
    #include <clipping_planes_vertex>
    seenZ = mvPosition.z;
    gl_Position = projectionMatrix * mvPosition;
    float wanted = ${kSizeInSpacings} * spacing * pixelsPerUnit / -seenZ;
    size = clamp(wanted, smallest, 14.0 * smallest);
    gl_PointSize = size;
    ink = hasValues ? colorOf(value) : vec4(color, 0.0);
  }`;

const kFragmentShader = `
  #include <clipping_planes_pars_fragment>
  uniform float spacing, behind;
  uniform mat4 projectionMatrix;
  varying float seenZ, size;
  varying vec4 ink;
  void main() {
    #include <clipping_planes_fragment>
    // A dome instead of a disc: where neighbors meet, depth is continuous. Small points use all
    // their pixels to close the surface.
    float off = 2.0 * length(gl_PointCoord - 0.5);
    if (off > 1.0 && size > 4.0) discard;
    float z = seenZ - spacing * off * off - behind;
    gl_FragDepth = 0.5 - 0.5 * (projectionMatrix[2][2] + projectionMatrix[3][2] / z);
    gl_FragColor = ink;
  }`;

/**
 * A scan as round points about as large as their spacing.
 *
 * positions  x, y, z of each in the scan's frame
 * frame      frameOf(positions)
 */
export function makeScanPoints(positions, frame) {
  // Relative to the center: a float has too few digits for details far from the origin.
  const { x, y, z } = frame.center;
  const centered = new Float32Array(positions.length);
  for (let i = 0; i < positions.length; i += 3) {
    centered[i] = positions[i] - x;
    centered[i + 1] = positions[i + 1] - y;
    centered[i + 2] = positions[i + 2] - z;
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(centered, 3));
  const material = new ShaderMaterial({
    uniforms: {
      color: { value: null },
      spacing: { value: spacing(centered) / frame.radius },
      behind: { value: kBehind },
      pixelsPerUnit: { value: 1 },
      smallest: { value: 1 },
      dim: { value: null },
      hasValues: { value: false },
      low: { value: 0 },
      high: { value: 1 },
      palette: { value: new PaletteTexture() },
    },
    clipping: true,
    vertexShader: kVertexShader,
    fragmentShader: kFragmentShader,
  });
  const points = new Points(geometry, material);
  points.frustumCulled = false;
  points.matrixAutoUpdate = false;
  points.matrix.copy(frame.toWorld).multiply(new Matrix4().makeTranslation(frame.center));
  return points;
}

/**
 * Colors the points by values; null: none.
 *
 * values     of each point; NaN is drawn dim
 * low, high  limits of the palette's steps
 */
export function colorScanPoints({ geometry, material: { uniforms } }, coloring) {
  uniforms.hasValues.value = Boolean(coloring);
  if (!coloring) return;
  const { values, low, high, palette } = coloring;
  if (!geometry.getAttribute("value")) {
    geometry.setAttribute("value", new BufferAttribute(new Float32Array(values.length), 1));
  }
  const attribute = geometry.getAttribute("value");
  for (let i = 0; i < values.length; ++i) {
    attribute.array[i] = Number.isNaN(values[i]) ? kNoValue : values[i];
  }
  attribute.needsUpdate = true;
  uniforms.low.value = low;
  uniforms.high.value = high;
  uniforms.palette.value.set(palette);
}

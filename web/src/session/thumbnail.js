/** Small pictures of scans, drawn point by point: a list of scans needs no WebGL. */

const kEdge = 0.02; // share of points beyond each border

function quantiles(values) {
  const sorted = Float32Array.from(values).sort();
  const at = (share) => sorted[Math.round(share * (sorted.length - 1))];
  return [at(kEdge), at(1 - kEdge)];
}

const unit = (v) => {
  const length = Math.hypot(...v) || 1;
  return v.map((x) => x / length);
};
const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/**
 * Draw points as their sensor saw them, the nearest brightest.
 *
 * canvas     of which the size stays
 * positions  x, y, z of each
 * viewpoint  of the sensor, in the same frame
 * color      [r, g, b] of the nearest
 */
export function drawThumbnail(canvas, positions, viewpoint, color) {
  const { width, height } = canvas;
  const count = positions.length / 3;
  const context = canvas.getContext("2d");
  context.clearRect(0, 0, width, height);
  if (!count) return;
  const middle = [0, 0, 0];
  for (let i = 0; i < positions.length; ++i) middle[i % 3] += positions[i] / count;
  const ahead = unit(middle.map((x, axis) => x - viewpoint[axis]));
  const right = unit(cross(Math.abs(ahead[1]) > 0.99 ? [0, 0, 1] : [0, 1, 0], ahead));
  const down = cross(ahead, right);
  const [u, v, depth] = [0, 1, 2].map(() => new Float32Array(count));
  for (let i = 0; i < count; ++i) {
    const ray = [0, 1, 2].map((axis) => positions[3 * i + axis] - viewpoint[axis]);
    depth[i] = dot(ray, ahead);
    u[i] = dot(ray, right) / depth[i];
    v[i] = dot(ray, down) / depth[i];
  }
  const [[u0, u1], [v0, v1], [near, far]] = [u, v, depth].map(quantiles);
  const scale = Math.max((u1 - u0) / width, (v1 - v0) / height) * 1.1 || 1;
  const image = context.createImageData(width, height);
  const nearest = new Float32Array(width * height).fill(Infinity);
  for (let i = 0; i < count; ++i) {
    const x = Math.floor(width / 2 + (u[i] - (u0 + u1) / 2) / scale);
    const y = Math.floor(height / 2 + (v[i] - (v0 + v1) / 2) / scale);
    const at = y * width + x;
    if (x < 0 || y < 0 || x >= width || y >= height || !(depth[i] < nearest[at])) continue;
    nearest[at] = depth[i];
    const shade = 1 - 0.75 * Math.min(1, Math.max(0, (depth[i] - near) / (far - near || 1)));
    image.data.set([...color, 255 * shade], 4 * at);
  }
  context.putImageData(image, 0, 0);
}

/** Scalar values of a scan's points, for coloring. */
import { quantile } from "./statistics.js";

const kSamples = 20000;
// This share of the points at either end has no influence on the range of colors.
const kStray = 0.01;

/** Distances from a position, in the frame of the positions. */
export function rangesFrom(positions, [x, y, z]) {
  const values = new Float32Array(positions.length / 3);
  for (let i = 0; i < values.length; ++i) {
    const dx = positions[3 * i] - x;
    const dy = positions[3 * i + 1] - y;
    const dz = positions[3 * i + 2] - z;
    values[i] = Math.sqrt(dx * dx + dy * dy + dz * dz);
  }
  return values;
}

/** Coordinates along an axis ("+x", "-z", …) in a frame whose origin is at -offset. */
export function heightsAlong(positions, axis, offset) {
  const k = "xyz".indexOf(axis[1]);
  const sign = axis[0] === "-" ? -1 : 1;
  const values = new Float32Array(positions.length / 3);
  for (let i = 0; i < values.length; ++i) values[i] = sign * (positions[3 * i + k] + offset[k]);
  return values;
}

/** Limits that contain all values except outliers: { low, high }, low < high. NaN is ignored. */
export function limitsOf(values) {
  const step = Math.max(1, Math.floor(values.length / kSamples));
  const sample = Float32Array.from(
    { length: Math.ceil(values.length / step) },
    (_, k) => values[k * step],
  )
    .filter((value) => !Number.isNaN(value))
    .sort();
  if (!sample.length) return { low: 0, high: 1 };
  const [low, high] = [quantile(sample, kStray), quantile(sample, 1 - kStray)];
  return { low, high: high > low ? high : low + 1e-6 };
}

/** Numbers and results in the form that an engineer reads. */
import { Matrix4, Quaternion } from "three";

import { wordsOf } from "./vocabulary.js";

const figures = (value, digits) => Number(value.toPrecision(digits)).toString().replace("-", "−");

/** A length given in a unit ("m" or "mm"), shown in the more readable one. */
export function lengthWords(value, unit) {
  if (!Number.isFinite(value)) return "unknown";
  const meters = unit === "mm" ? value / 1000 : value;
  return Math.abs(meters) < 1 ? `${figures(meters * 1000, 3)} mm` : `${figures(meters, 3)} m`;
}

/** A point in the scan's unit, which robots are taught in. */
export function pointWords(point, unit) {
  const digits = unit === "mm" ? 1 : 4;
  const number = (value) => value.toFixed(digits).replace("-", "−");
  return `${point.map(number).join(", ")} ${unit}`;
}

/** How far off a pose may be: a standard deviation along and about each axis of the model. */
export function sigmaWords({ translation, rotation_deg: turns }, unit) {
  const listed = (values, words) => values.map(words).join(", ");
  const degrees = (value) => `${figures(value, 2)}°`;
  return (
    `± ${listed(translation, (value) => lengthWords(value, unit))} along the model's x, y, z;` +
    ` ± ${listed(turns, degrees)} about them`
  );
}

/** What tells a candidate from the model that is named first. */
export function candidateWords({ model, share, rays, differs }, unit) {
  const name = `${model} ${percentWords(share)}`;
  if (!differs) return name;
  const seen =
    rays === 0 ? "not seen from here, seen from" : `${numbered(rays, "ray", "rays")} there, seen best from`;
  return (
    `${name}: differs by up to ${lengthWords(differs.deviation, unit)} around ${pointWords(differs.center, unit)};` +
    ` ${seen} (${axisWords(differs.look_from)})`
  );
}

export const placeWords = (point, unit) =>
  point.every((value) => value === 0) ? "the origin" : pointWords(point, unit);

export function secondsWords(value) {
  if (value >= 1) return `${value.toFixed(2)} s`;
  const ms = value * 1000;
  return `${ms < 10 ? ms.toFixed(1) : ms.toFixed(0)} ms`;
}

/** A probability without invented digits: it is never 0 or 1. */
export function scoreWords(score) {
  if (score < 0.001) return "< 0.001";
  return score > 0.999 ? "> 0.999" : score.toFixed(3);
}

export const countWords = (count) => count.toLocaleString("en");
export const numbered = (count, one, many) => `${countWords(count)} ${count === 1 ? one : many}`;

export function percentWords(share) {
  if (share > 0 && share < 0.01) return "under 1 %";
  return `${Math.round(100 * share)} %`;
}

export const signed = (value) => `${value < 0 ? "−" : "+"}${Math.abs(value).toFixed(1)}`;

/** What proposed a pose. */
export const methodWords = (method) => wordsOf("methods")[method] ?? method;

/** poses  besides the identity; axis  whether the model is symmetric about one */
export function symmetryWords({ poses, axis }) {
  if (axis) return "turns freely about an axis";
  if (poses > 0) return `looks the same in ${poses + 1} poses`;
  return "no symmetry";
}

/** poses  besides the identity; axis  whether the model is nearly symmetric about one */
export function nearSymmetryWords({ poses, axis }) {
  if (axis) return "nearly turns freely about an axis";
  return `looks nearly the same in ${poses + 1} poses`;
}

/**
 * Why a pose was rejected, in the service's words, with the position of the pose that explains it.
 */
export function rejectionWords({ words, explained_by: by }) {
  return by === null ? words : `${words} (${by + 1})`;
}

/** The measured fraction of the whole object, and where the rest is, if that is significant. */
export function visibilityWords(pose) {
  const kHardly = 0.01;
  return [
    `${percentWords(pose.visible_fraction)} visible`,
    pose.hidden_fraction >= kHardly && `${percentWords(pose.hidden_fraction)} hidden`,
    pose.outside_fraction >= kHardly && `${percentWords(pose.outside_fraction)} outside the scan`,
  ]
    .filter(Boolean)
    .join(", ");
}

/**
 * The rotation of a pose.
 *
 * rows  of the matrix of a rigid motion
 * Returns { quaternion: [x, y, z, w], w >= 0; angle: [degrees], 0 to 180; axis: unit vector }.
 */
export function orientationOf(rows) {
  const turn = rows.slice(0, 3).map((row) => [...row.slice(0, 3), 0]);
  const matrix = new Matrix4().set(...turn.flat(), 0, 0, 0, 1);
  // The matrix is only nearly orthonormal if it was stored as floats.
  const { x: a, y: b, z: c, w: d } = new Quaternion().setFromRotationMatrix(matrix).normalize();
  const quaternion = d < 0 ? [-a, -b, -c, -d] : [a, b, c, d];
  const [x, y, z, w] = quaternion;
  const sine = Math.hypot(x, y, z);
  return {
    quaternion,
    angle: (360 / Math.PI) * Math.atan2(sine, w),
    axis: sine > 0 ? [x / sine, y / sine, z / sine] : [0, 0, 1],
  };
}

// Rounded first, to avoid negative zero.
const fixed = (digits) => (value) =>
  (Number(value.toFixed(digits)) || 0).toFixed(digits).replace("-", "−");
export const axisWords = (axis) => axis.map(fixed(2)).join(", ");
export const turnWords = ({ angle, axis }) => `${angle.toFixed(1)}° about ${axisWords(axis)}`;
export const quaternionWords = ({ quaternion }) => quaternion.map(fixed(4)).join(", ");

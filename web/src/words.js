/** Numbers and findings as an engineer reads them. */

const figures = (value, digits) => Number(value.toPrecision(digits)).toString().replace("-", "−");

/** A length in the given unit ("m" or "mm"), told in the one that reads better. */
export function lengthWords(value, unit) {
  if (!Number.isFinite(value)) return "unknown";
  const meters = unit === "mm" ? value / 1000 : value;
  return Math.abs(meters) < 1 ? `${figures(meters * 1000, 3)} mm` : `${figures(meters, 3)} m`;
}

/** A point in the scan's own unit, since that is what robots are taught in. */
export function pointWords(point, unit) {
  const digits = unit === "mm" ? 1 : 4;
  const number = (value) => value.toFixed(digits).replace("-", "−");
  return `${point.map(number).join(", ")} ${unit}`;
}

export function secondsWords(value) {
  if (value >= 1) return `${value.toFixed(2)} s`;
  const ms = value * 1000;
  return `${ms < 10 ? ms.toFixed(1) : ms.toFixed(0)} ms`;
}

export const scoreWords = (score) => score.toFixed(3);
export const countWords = (count) => count.toLocaleString("en");
export const numbered = (count, one, many) => `${countWords(count)} ${count === 1 ? one : many}`;

export function percentWords(share) {
  if (share > 0 && share < 0.01) return "under 1 %";
  return `${Math.round(100 * share)} %`;
}

export const signed = (value) => `${value < 0 ? "−" : "+"}${Math.abs(value).toFixed(1)}`;

const kMethods = {
  ppf: "point pairs",
  trisi: "Tri-Spin-Images",
  expected: "an expected pose",
};
export const methodWords = (method) => kMethods[method] ?? method;

/** poses  beside the model's own; axis  whether it turns about one */
export function symmetryWords({ poses, axis }) {
  if (axis) return "turns freely about an axis";
  if (poses > 0) return `looks the same in ${poses + 1} poses`;
  return "no symmetry";
}

/**
 * Why a pose was rejected.
 *
 * detections  what was found instead, in the order of the answer
 * minScore    the limit that was asked for
 */
export function rejectionWords(rejected, detections, minScore) {
  const by = detections[rejected.explained_by];
  const taken = by
    ? `${by.model} (${rejected.explained_by + 1}, score ${scoreWords(by.score)}) ` +
      `already explains ${percentWords(rejected.explained_share)} of its pixels`
    : "a better pose already explains its pixels";
  switch (rejected.reason) {
    case "too_low": {
      const low = `score ${scoreWords(rejected.score)} is below the limit ${minScore}`;
      return by ? `${low}; ${taken}` : low;
    }
    case "explained":
      return taken;
    case "too_many":
      return "as many of this model as asked for have better scores";
    default:
      return rejected.reason;
  }
}

import { element } from "./dom.js";
import { lengthWords, scoreWords } from "./words.js";

/** Lengths of a scan along its axes, in its unit. */
function extents(positions) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < positions.length; ++i) {
    low[i % 3] = Math.min(low[i % 3], positions[i]);
    high[i % 3] = Math.max(high[i % 3], positions[i]);
  }
  return low.map((value, axis) => high[axis] - value);
}

/**
 * What to check when no model was found.
 *
 * positions  of the scan's points, or null; unit  of the scan
 * library    { unit, models }; rejected  poses, best first
 */
export function adviceOnNothing({ positions, unit, library, rejected, minScore, format }) {
  const diameters = library.models.map((model) => model.diameter);
  const checks = [];
  if (rejected.length) {
    const [best] = rejected;
    checks.push(
      `The best rejected pose is ${best.model} with score ${scoreWords(best.score)}, and the ` +
        `lowest score is ${minScore}. The button Rejected shows it.`,
    );
  }
  if (positions?.length && diameters.length) {
    const sizes = extents(positions)
      .map((size) => lengthWords(size, unit))
      .join(" × ");
    checks.push(
      `In ${unit}, the scan is ${sizes}, and the models are ` +
        `${lengthWords(Math.min(...diameters), library.unit)} to ` +
        `${lengthWords(Math.max(...diameters), library.unit)} across. Does that fit?`,
    );
  }
  checks.push(
    format === "png"
      ? "Is the camera right? With a wrong focal length every shape is distorted."
      : "Was the sensor where the settings say? What it saw through speaks against a model.",
  );
  return [
    element("p", {}, "What to check:"),
    element(
      "ul",
      {},
      checks.map((check) => element("li", {}, check)),
    ),
  ];
}

import words from "./advice.json";
import { element } from "./dom.js";
import { extents } from "./extents.js";
import { lengthWords, scoreWords } from "./words.js";

const fill = (sentence, values) => sentence.replace(/\{(\w+)\}/g, (_, name) => values[name]);

/**
 * Advice for a scan without detections. `trivet recognize` gives the same advice, from advice.json.
 *
 * positions  points of the scan, or null; unit  unit of the scan
 * library    { unit, models }; rejected  rejected poses, best first
 */
export function adviceOnNothing({ positions, unit, library, rejected, minScore, isDepth }) {
  const diameters = library.models.map((model) => model.diameter);
  const checks = [];
  if (rejected.length) {
    const [best] = rejected;
    checks.push(
      `${fill(words.rejected, {
        model: best.model,
        score: scoreWords(best.score),
        limit: minScore,
      })} The button Rejected shows it.`,
    );
  }
  if (positions?.length && diameters.length) {
    const sizes = extents(positions)
      .map((size) => lengthWords(size, unit))
      .join(" × ");
    checks.push(
      fill(words.sizes, {
        unit,
        scan: sizes,
        smallest: lengthWords(Math.min(...diameters), library.unit),
        largest: lengthWords(Math.max(...diameters), library.unit),
      }),
    );
  }
  checks.push(isDepth ? words.camera : words.viewpoint);
  return [
    element("p", {}, "What to check:"),
    element(
      "ul",
      {},
      checks.map((check) => element("li", {}, check)),
    ),
  ];
}

import { element, terms } from "../dom.js";
import { colorOf, cssColor, kPalettes } from "../view/palettes.js";
import { countWords, lengthWords, percentWords } from "../words.js";
import { countWithin, histogramOf } from "./statistics.js";

const kSvg = "http://www.w3.org/2000/svg";
const kBins = 50;
// The drawing has this width in its own units, and is scaled to the available width.
const kWidth = 300;
const kHeight = 84;
// The height of the part below the bars.
const kFoot = 18;

function svg(tag, attributes, ...children) {
  const made = document.createElementNS(kSvg, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

/** A histogram in the colors of the scan, with the tolerance limits as lines. */
function histogram(counts, band, tolerance, unit) {
  const most = Math.max(...counts);
  const at = (distance) => (kWidth * (distance + band)) / (2 * band);
  const width = kWidth / counts.length;
  const bars = Array.from(counts, (count, k) => {
    const height = (count / most) * (kHeight - kFoot - 4);
    const middle = ((k + 0.5) / counts.length) * 2 * band - band;
    return svg("rect", {
      x: (k * width).toFixed(2),
      y: (kHeight - kFoot - height).toFixed(2),
      width: (width - 0.5).toFixed(2),
      height: height.toFixed(2),
      fill: cssColor(colorOf(kPalettes.deviation, middle, -tolerance, tolerance)),
    });
  });
  const limits = [-tolerance, tolerance]
    .filter((limit) => Math.abs(limit) < band)
    .map((limit) =>
      svg("line", { class: "limit", x1: at(limit), x2: at(limit), y1: 0, y2: kHeight - kFoot }),
    );
  const floor = kHeight - kFoot;
  const axis = svg("line", { class: "axis", x1: 0, x2: kWidth, y1: floor, y2: floor });
  const label = (distance, anchor) =>
    svg(
      "text",
      { x: at(distance), y: kHeight - 4, "text-anchor": anchor },
      (distance > 0 ? "+" : "") + lengthWords(distance, unit),
    );
  return svg(
    "svg",
    {
      class: "histogram",
      viewBox: `0 0 ${kWidth} ${kHeight}`,
      role: "img",
      "aria-label":
        `Histogram of the distances within ±${lengthWords(band, unit)}, ` +
        `with the tolerance of ±${lengthWords(tolerance, unit)}`,
    },
    ...bars,
    ...limits,
    axis,
    label(-band, "start"),
    label(0, "middle"),
    label(band, "end"),
  );
}

/**
 * The measurement in numbers and as a histogram.
 *
 * measured   { distances, isClosed, figures } of measureDistances
 * band, tolerance  in the unit of the scan
 */
export function resultsView({ distances, isClosed, figures }, { band, tolerance, unit }) {
  if (!figures.num) {
    return [
      element("p", {}, `No point of the scan is within ${lengthWords(band, unit)} of the surface.`),
    ];
  }
  const within = countWithin(distances, tolerance) / figures.num;
  const signedWords = (value) => `${value > 0 ? "+" : ""}${lengthWords(value, unit)}`;
  return [
    histogram(histogramOf(distances, band, kBins), band, tolerance, unit),
    terms([
      ["rms error", lengthWords(figures.rms, unit)],
      ["mean", signedWords(figures.mean)],
      ["95 % within", `±${lengthWords(figures.p95, unit)}`],
      ["in tolerance", percentWords(within)],
      ["points", `${countWords(figures.num)} of ${countWords(distances.length)} drawn`],
    ]),
    element(
      "p",
      { className: "dim" },
      `All points within ±${lengthWords(band, unit)} count, those of neighbors and of the table among ` +
        "them; the rmse of what is found counts only points that agree with it. " +
        (isClosed
          ? "Positive is outside the model."
          : "A mesh is open, so it has no inside: positive is where its faces look."),
    ),
  ];
}

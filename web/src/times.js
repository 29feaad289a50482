import { element } from "./dom.js";
import { secondsWords } from "./words.js";

const kShortest = 5e-5; // [s]: what would read as 0.0 ms goes untold
const kTones = 6; // classes tone-0 … of the style sheet

/**
 * Where the time of an answer went: a stacked bar, and its numbers.
 *
 * answer   of the service
 * seconds  from sending the request to the end of the answer
 */
export function timesView(answer, seconds) {
  const { queue = 0, work = 0 } = answer.seconds ?? {};
  const { total = 0, ...stages } = answer.scenes[0]?.seconds ?? {};
  const rest = {
    queue,
    ...stages,
    "other work": Math.max(0, work - total),
    transfer: Math.max(0, seconds - queue - work),
  };
  const all = Object.entries(rest).filter(([, value]) => value >= kShortest);
  const sum = all.reduce((so_far, [, value]) => so_far + value, 0) || 1;
  const bar = element("div", { className: "stack", "aria-hidden": "true" });
  const rows = all.map(([name, value], k) => {
    const piece = element("span", {
      className: `tone-${k % kTones}`,
      title: `${name} ${secondsWords(value)}`,
    });
    piece.style.width = `${(100 * value) / sum}%`;
    bar.append(piece);
    return element(
      "li",
      {},
      element("span", { className: `swatch tone-${k % kTones}`, "aria-hidden": "true" }),
      element("span", {}, name),
      element("span", { className: "number" }, secondsWords(value)),
    );
  });
  return [
    element(
      "p",
      {},
      "Round trip ",
      element("b", {}, secondsWords(seconds)),
      ", of it work ",
      element("b", {}, secondsWords(work)),
    ),
    bar,
    element("ul", { className: "stages" }, rows),
  ];
}

import { element } from "./dom.js";
import { secondsWords } from "./words.js";

// Shorter times would read as 0.0 ms and are left out [s].
const kShortest = 5e-5;

/** The stages of recognition in words, in their order; the colors are those of the style sheet. */
const kGroups = [
  { name: "waiting for its turn", stages: ["queue"] },
  { name: "reading the scan", stages: ["read", "prepare", "subsample"] },
  { name: "proposing poses", stages: ["vote", "cluster", "match"] },
  { name: "refining them", stages: ["preselect", "refine", "verify"] },
  { name: "testing the best", stages: ["examine", "select", "alternatives", "check camera"] },
  { name: "transfer and the rest", stages: ["other work", "transfer"] },
];
const groupOf = (stage) => {
  const known = kGroups.findIndex(({ stages }) => stages.includes(stage));
  return known < 0 ? kGroups.length - 1 : known;
};

/**
 * The time of each stage of an answer: a stacked bar, and its numbers.
 *
 * answer   of the service
 * seconds  from sending the request to the end of the response
 */
export function timesView(answer, seconds) {
  const { queue = 0, work = 0 } = answer.seconds ?? {};
  const { total = 0, ...stages } = answer.scenes[0]?.seconds ?? {};
  const groups = kGroups.map(({ name }, k) => ({ name, tone: k, seconds: 0, stages: [] }));
  for (const [stage, value] of Object.entries({
    queue,
    ...stages,
    "other work": Math.max(0, work - total),
    transfer: Math.max(0, seconds - queue - work),
  })) {
    const group = groups[groupOf(stage)];
    group.seconds += value;
    if (value >= kShortest) group.stages.push(`${stage} ${secondsWords(value)}`);
  }
  const told = groups.filter((group) => group.seconds >= kShortest);
  const sum = told.reduce((so_far, group) => so_far + group.seconds, 0) || 1;
  const bar = element("div", { className: "stack", "aria-hidden": "true" });
  const rows = told.map((group) => {
    const title = group.stages.join(", ");
    const piece = element("span", { className: `tone-${group.tone}`, title });
    piece.style.width = `${(100 * group.seconds) / sum}%`;
    bar.append(piece);
    return element(
      "li",
      { title },
      element("span", { className: `swatch tone-${group.tone}`, "aria-hidden": "true" }),
      element("span", {}, group.name),
      element("span", { className: "number" }, secondsWords(group.seconds)),
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

import { element } from "./dom.js";
import { wordsOf } from "./vocabulary.js";
import { scoreWords, signed } from "./words.js";

/** An element with this fraction of the width of its parent. */
function share(className, value) {
  const made = element("span", { className });
  made.style.width = `${100 * Math.min(1, Math.max(0, value))}%`;
  return made;
}

/** A smaller value is rounding, not a share of other answers. */
const kNothing = 0.005;
/** Beyond this probability the odds of a float are rounding. */
const kLeast = 1e-6;

function logOdds(score) {
  const inside = Math.min(1 - kLeast, Math.max(kLeast, score));
  return Math.log(inside / (1 - inside));
}

function row({ label, meaning, track, number }) {
  return element(
    "li",
    { title: meaning },
    element("span", { className: "label" }, label),
    track ?? element("span", {}),
    element("span", { className: "number" }, number),
    element("span", { className: "meaning dim" }, meaning),
  );
}

function partRow({ label, meaning, limit, added }, most) {
  const track = element("span", { className: "track" });
  track.append(share("limit", limit / most), share("added", added / most));
  const number = [added.toFixed(1), element("span", { className: "dim" }, ` of ${limit.toFixed(1)}`)];
  return row({ label, meaning, track, number });
}

/**
 * The composition of a score, in rows that sum to its log odds: the bias, each part beside its
 * maximum, and the deduction for other answers.
 *
 * pose        { score, evidence: { part: log odds }, parts: { correlation } } of the service
 * scoreParts  { bias, parts: [{ name, label, meaning, most_evidence }] }, where bias and
 *             most_evidence are two numbers: for a correlation of 0, and for one of 1
 */
export function scoreBars({ score, evidence, parts: { correlation } }, scoreParts) {
  const { begin, others: beside, sum } = wordsOf("score");
  const mixed = ([none, full]) => none + (full - none) * (correlation ?? 0);
  const bias = mixed(scoreParts.bias);
  const order = scoreParts.parts
    .map((part) => ({
      ...part,
      limit: mixed(part.most_evidence),
      added: evidence[part.name] ?? 0,
    }))
    .sort((a, b) => b.limit - a.limit);
  const most = order[0]?.limit || 1;
  const alone = order.reduce((total, { added }) => total + added, bias);
  const others = logOdds(score) - Math.max(-14, Math.min(14, alone));
  // The others would read "0.0 of 0.0".
  const told = order.filter(({ limit }) => limit >= 0.05);
  const list = element(
    "ul",
    { className: "score-bars" },
    row({ ...begin, number: signed(bias) }),
    told.map((part) => partRow(part, most)),
    others < -kNothing &&
      row({
        ...beside,
        track: element("span", { className: "track" }, share("taken", -others / most)),
        number: signed(others),
      }),
    row({
      label: sum.label,
      meaning: `${sum.meaning}, ${scoreWords(score)}`,
      number: element("b", {}, signed(alone + Math.min(0, others))),
    }),
  );
  const explain = element(
    "button",
    {
      type: "button",
      className: "plain",
      "aria-expanded": "false",
      onclick: () => {
        const open = list.classList.toggle("explained");
        explain.setAttribute("aria-expanded", open);
        explain.textContent = open ? "Without explanations" : "What do these mean?";
      },
    },
    "What do these mean?",
  );
  return [
    element("h3", {}, "What the score is made of"),
    element("p", { className: "dim" }, "Log odds of the score: the rows add up."),
    list,
    explain,
  ];
}

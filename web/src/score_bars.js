import { element } from "./dom.js";
import { signed } from "./words.js";

/** An element as wide as this share of the one around it. */
function share(className, value) {
  const made = element("span", { className });
  made.style.width = `${100 * Math.min(1, Math.max(0, value))}%`;
  return made;
}

/**
 * What a score is made of: each part's log odds beside the most it could add.
 *
 * pose        { evidence: { part: log odds }, parts: { correlation } } of the service
 * scoreParts  { bias, parts: [{ name, label, meaning, most_evidence }] }, where bias and
 *             most_evidence are two numbers: for a correlation of 0, and for one of 1
 */
export function scoreBars({ evidence, parts: { correlation } }, scoreParts) {
  const mixed = ([none, full]) => none + (full - none) * (correlation ?? 0);
  const bias = mixed(scoreParts.bias);
  const order = scoreParts.parts
    .map((part) => ({ ...part, limit: mixed(part.most_evidence) }))
    .sort((a, b) => b.limit - a.limit);
  const most = order[0]?.limit || 1;
  const sum = order.reduce((total, { name }) => total + (evidence[name] ?? 0), bias);
  const rows = order.map(({ name, label, meaning, limit }) => {
    const added = evidence[name] ?? 0;
    const track = element("span", { className: "track" });
    track.append(share("limit", limit / most), share("added", added / most));
    return element(
      "li",
      { title: meaning },
      element("span", { className: "label" }, label),
      track,
      element(
        "span",
        { className: "number" },
        added.toFixed(1),
        element("span", { className: "dim" }, ` of ${limit.toFixed(1)}`),
      ),
      element("span", { className: "meaning dim" }, meaning),
    );
  });
  const list = element("ul", { className: "score-bars" }, rows);
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
    element(
      "p",
      { className: "dim" },
      `Log odds ${signed(sum)}: they begin at ${signed(bias)}, and each part adds up to its limit.`,
    ),
    list,
    explain,
  ];
}

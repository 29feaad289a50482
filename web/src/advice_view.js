import { element } from "./dom.js";

/**
 * What to check in a scan without detections, as a list; nothing without advice.
 *
 * advice  [{ about, words }] of the service
 */
export function adviceView(advice) {
  if (!advice.length) return [];
  const sentence = ({ about, words }) =>
    about === "rejected" ? `${words} The button Rejected shows it.` : words;
  return [
    element("p", {}, "What to check:"),
    element(
      "ul",
      {},
      advice.map((one) => element("li", {}, sentence(one))),
    ),
  ];
}

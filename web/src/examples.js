import { byId, element, moveByArrows } from "./dom.js";
import { fetchExamples } from "./service.js";
import { countWords } from "./words.js";

/**
 * Lists the example scans of the service and returns them. open(example) is called for the selected
 * one.
 */
export async function showExamples(open) {
  const examples = await fetchExamples();
  const rows = examples.map((example) =>
    element(
      "li",
      {},
      element("button", { type: "button", onclick: () => open(example) }, example.name),
    ),
  );
  byId("examples").replaceChildren(...rows);
  byId("examples-box").hidden = !rows.length;
  byId("examples-count").textContent = countWords(rows.length);
  moveByArrows(byId("examples"), "button");
  return examples;
}

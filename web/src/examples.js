import { byId, element, moveByArrows } from "./dom.js";
import { fetchExamples } from "./service.js";
import { countWords } from "./words.js";

/**
 * List the scans that the service offers; open(example) is called for the one that is picked.
 * Returns them.
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

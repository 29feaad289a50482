import { copiesOnClick } from "./copy.js";
import { byId, element, terms } from "./dom.js";
import { downloadsText } from "./download.js";

/**
 * Shows which service answered, and offers the response to copy or download.
 *
 * text, answer  the response as received, and parsed
 * scanName      the base of the file name
 */
export function showAnswer({ text, answer }, scanName) {
  byId("answer").replaceChildren(
    terms([
      ["request", element("code", {}, answer.request_id)],
      ["library", `${answer.library.file}, generation ${answer.library.generation}`],
    ]),
  );
  byId("copy").textContent = "Copy JSON";
  copiesOnClick(byId("copy"), text);
  downloadsText(byId("download"), text, "application/json", scanName, "trivet.json");
  byId("answer-section").hidden = false;
}

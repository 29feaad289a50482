/** The headline of the result, and the problem below it. */
import { byId, element } from "../dom.js";
import { state } from "./state.js";

export function say(headline) {
  byId("headline").textContent = headline;
  document.title = state.scan ? `${headline} – ${state.scan.name} – Trivet` : "Trivet";
}

export function setBusy(busy) {
  byId("progress").hidden = !busy;
  byId("result").setAttribute("aria-busy", busy);
}

/** action  { label, run } that may solve the problem, if any */
export function showProblem(message, action) {
  byId("problem").replaceChildren(
    element("p", {}, message),
    action ? element("button", { type: "button", onclick: action.run }, action.label) : "",
  );
}

export const tryAgain = (act) => ({ label: "Try again", run: act });

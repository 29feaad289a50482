/** The tools that take a place of the scan by a click: the question why, and the ruler. */
import { byId } from "../dom.js";
import { explainPlace } from "./explanation.js";
import { select } from "./selection.js";
import { state, view } from "./state.js";

const kHints = {
  ask: "Click a place to learn why a part is found there, or none; Enter: the middle. Esc ends.",
  ruler: "Click two points; Enter: the middle of the view. Esc ends.",
};

export const kTools = Object.keys(kHints);

// The tool in use; null: a click selects.
let tool = null;

function setTool(next) {
  tool = next;
  for (const other of kTools) byId(other).setAttribute("aria-pressed", other === next);
  byId("canvas").classList.toggle("asks", next !== null);
  byId("tool-hint").textContent = next ? kHints[next] : "";
  if (next) byId("canvas").focus({ preventScroll: true });
  if (view) view.asks = next !== null;
}

export const toggleTool = (which) => view && setTool(tool === which ? null : which);

/** Uses the tool at a point of the scan as drawn. */
export function takePlace(point) {
  if (tool === "ask") return explainPlace(point);
  byId("measure-box").open = true;
  return state.panels.measure.ruler.take(point);
}

/** Deselects the tool, or else the shown item. */
export function letGo() {
  if (!tool) return select(null);
  if (tool === "ruler") state.panels.measure.ruler.clear();
  return setTool(null);
}

import { byId } from "../dom.js";
import { showTools } from "./layers.js";
import { state, view } from "./state.js";

export const kTabs = ["result", "models", "session"];

// How far each tab was scrolled.
const scrolled = new Map();

/** Shows a tab of the panel, and the scan again in the view if that is not the one of the models. */
export function showTab(name) {
  const panel = byId("panel");
  const before = kTabs.find((other) => !byId(other).hidden);
  if (before) scrolled.set(before, panel.scrollTop);
  for (const other of kTabs) {
    byId(other).hidden = other !== name;
    byId(`tab-${other}`).setAttribute("aria-selected", other === name);
  }
  if (before !== name) panel.scrollTop = scrolled.get(name) ?? 0;
  if (name === "models") return;
  view?.closeModel();
  state.panels.libraryPanel.mark(null);
  showTools();
  byId("welcome").hidden = Boolean(state.scan) || !view;
  byId("view-title").textContent = state.scan?.name ?? "";
}

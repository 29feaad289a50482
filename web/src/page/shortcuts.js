/** The keys of the page. */
import { byId } from "../dom.js";
import { toggleLayer } from "./layers.js";
import { state, view } from "./state.js";
import { showTab } from "./tabs.js";
import { letGo, toggleTool } from "./tools.js";

function toggleModels() {
  const opens = byId("models").hidden;
  showTab(opens ? "models" : "result");
  if (opens) state.panels.libraryPanel.focus();
  else byId("tab-result").focus();
}

function showSession() {
  const { session } = state.panels;
  if (!session.isKept) return;
  showTab("session");
  session.focus();
}

const kShortcuts = {
  o: () => byId("files").click(),
  f: () => view?.fit(),
  s: () => toggleLayer("scan"),
  d: () => toggleLayer("found"),
  r: () => toggleLayer("rejected"),
  w: () => toggleTool("ask"),
  l: () => toggleTool("ruler"),
  v: () => state.panels.liveStrip.toggle(),
  b: () => state.limits.toggleRegion(),
  t: () => state.limits.toggleTilt(),
  m: toggleModels,
  e: showSession,
  y: () => state.panels.session.mark(true),
  n: () => state.panels.session.mark(false),
  a: () => state.panels.session.markAll(),
  "?": () => byId("help").showModal(),
  Escape: letGo,
};

/** Acts on a key, unless the user types into a field or the help is open. */
export function onShortcut(event) {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  if (byId("help").open || event.target.matches("input, select, textarea")) return;
  const act = Object.hasOwn(kShortcuts, event.key) ? kShortcuts[event.key] : null;
  if (!act) return;
  event.preventDefault();
  act();
}

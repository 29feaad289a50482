/** The layers of the view, and which of its tools are offered. */
import { byId } from "../dom.js";
import { select } from "./selection.js";
import { state, view } from "./state.js";

export const kLayers = ["scan", "found", "rejected"];

export const isLayerShown = (layer) =>
  byId(`layer-${layer}`).getAttribute("aria-pressed") === "true";

export function showLayer(layer, shown) {
  byId(`layer-${layer}`).setAttribute("aria-pressed", shown);
  view?.setLayers({ [layer]: shown });
  if (layer !== "rejected") return;
  byId("rejected-section").hidden = !shown || byId("times-section").hidden;
  if (!shown && state.selected?.startsWith("rejected")) select(null);
}

export const toggleLayer = (layer) => showLayer(layer, !isLayerShown(layer));

/** Shows the tools of the view if it is not empty, and those for scans if it shows a scan. */
export function showTools(model = false) {
  byId("tools").hidden = !view || !(state.points || model);
  for (const layer of kLayers) byId(`layer-${layer}`).hidden = model;
  for (const tool of ["ask", "ruler"]) byId(tool).hidden = model;
  byId("limits").hidden = !view || !state.points || model;
  state.panels.measure?.show(!model);
}

/** What the parts of the page share: its view, its panels, and what is shown at present. */
import { byId } from "../dom.js";
import { Meshes } from "../view/meshes.js";
import { SceneView } from "../view/scene_view.js";

function makeView() {
  try {
    return new SceneView(byId("canvas"), byId("marks"));
  } catch {
    byId("no-webgl").hidden = false;
    byId("canvas").hidden = true;
    return null;
  }
}

/** The 3-D view; null: the browser has no WebGL. */
export const view = makeView();
/** The meshes of the library's models. */
export const meshes = new Meshes();

/**
 * library      as the service lists it
 * scoreParts   the parts of a score; null: not yet fetched
 * settings     the form of the settings; null: not yet made
 * limits       the limits of poses in form and view; null: not yet made
 * scan         the current one
 * points       of the scan, { key, positions, offset, total, viewpoint }; null: not yet fetched
 * running      the AbortController of the pending request
 * things       what is drawn of the result
 * rays         by the id of a thing, the verdicts of its rays
 * selected     the id of the selected thing
 * panels       { libraryPanel, partsPanel, robot, robotPanel, liveStrip, session, measure }, where
 *              measure is null without a view
 */
export const state = {
  library: { unit: "m", models: [], generation: 0 },
  scoreParts: null,
  settings: null,
  limits: null,
  scan: null,
  points: null,
  running: null,
  things: [],
  rays: new Map(),
  selected: null,
  panels: {},
};

/** The library of the service, and its models in the view. */
import { Matrix4, Vector3 } from "three";

import { byId } from "../dom.js";
import * as service from "../service.js";
import { lengthWords, numbered } from "../words.js";
import { showTools } from "./layers.js";
import { meshes, state, view } from "./state.js";

// The color of a model shown by itself.
const kAloneColor = "#8fa3b8";

export async function loadLibrary() {
  const library = await service.fetchLibrary();
  const { libraryPanel, partsPanel } = state.panels;
  state.library = library;
  meshes.setModels(library.models);
  libraryPanel.show(library, partsPanel.allowed);
  partsPanel.models = library.models;
  state.settings?.takeModels(library.models);
  byId("library-facts").textContent =
    `${library.library}: ${numbered(library.models.length, "model", "models")}, ` +
    `generation ${library.generation}`;
}

/** Makes a change to the library and shows the outcome. */
export async function changeLibrary(change) {
  try {
    await change();
    await loadLibrary();
  } catch (error) {
    byId("models-count").textContent = error.message;
  }
}

/** source  of its mesh; turn  a near symmetry, drawn over the model: see fetchNearTurnsOfModel */
export async function showModel(model, source = meshes, turn = null) {
  try {
    const geometry = await source.get(model.name);
    if (byId("models").hidden) return;
    const axes = [
      ...model.symmetry.axes,
      ...model.near_symmetry.axes.map((axis) => ({ ...axis, near: true })),
    ];
    const turned = turn && {
      matrix: new Matrix4().set(...turn.measured.flat()),
      place: new Vector3(...turn.place),
    };
    const shownAxes = turn ? [{ ...turn.axis, near: true }] : axes;
    view?.showModel(geometry, kAloneColor, shownAxes, turned);
    state.panels.libraryPanel.mark(model);
    showTools(true);
    byId("welcome").hidden = true;
    const off = turn && lengthWords(turn.deviation.largest, state.library.unit);
    byId("view-title").textContent = turn
      ? `${model.name}, turned: ${off} off at the ball`
      : model.name;
  } catch (error) {
    byId("models-count").textContent = error.message;
  }
}

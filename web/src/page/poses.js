/** The models of a result, posed in the view. */
import { Matrix4, Vector3 } from "three";

import { byId } from "../dom.js";
import { unitScale } from "../units.js";
import { numbered } from "../words.js";
import { meshes, state, view } from "./state.js";

/** A position in the scan's frame as its points are drawn, which may have an offset. */
export function besideOffset(place) {
  return place.map((x, axis) => x - (state.points?.offset[axis] ?? 0));
}

/** The transform from a model's vertices, in the library's unit, to the points as drawn. */
function poseMatrix(rows) {
  const scale = unitScale(state.library.unit, state.settings.unit);
  return new Matrix4()
    .set(...rows.flat())
    .setPosition(...besideOffset(rows.slice(0, 3).map((row) => row[3])))
    .scale(new Vector3().setScalar(scale));
}

/** Draws the posed models in the view. */
export async function drawPoses(things, signal) {
  if (!view) return;
  meshes.keep(new Set(things.map((thing) => thing.pose.model)));
  const drawn = await Promise.all(
    things.map(async (thing) => ({
      id: thing.id,
      kind: thing.kind,
      label: thing.label,
      name: thing.pose.model,
      color: thing.color,
      geometry: await meshes.get(thing.pose.model),
      pose: poseMatrix(thing.pose.T_scene_model),
      alternatives: (thing.pose.alternatives ?? []).map(poseMatrix),
    })),
  );
  if (signal.aborted) return;
  view.setThings(drawn);
  view.select(state.selected);
  const found = drawn.filter((thing) => thing.kind === "found");
  state.panels.measure.setThings(found);
  byId("canvas").setAttribute(
    "aria-label",
    `Scan ${state.scan.name} with ${numbered(found.length, "model", "models")} drawn in`,
  );
}

/** The lists of the result, and the thing that is selected in them and in the view. */
import { byId } from "../dom.js";
import { PoseList } from "../pose_list.js";
import { WhyList } from "../why_list.js";
import { state, view } from "./state.js";

export const lists = {
  found: new PoseList(
    byId("found"),
    (id) => select(id),
    (id) => state.panels.session.buttonsFor(id),
  ),
  rejected: new PoseList(byId("rejected"), (id) => select(id)),
  why: new WhyList(byId("why"), (id) => lookAt(id)),
};

/** Selects the thing with this id everywhere; null: none. */
export function select(id) {
  state.selected = id;
  for (const list of Object.values(lists)) list.open(id);
  view?.showRays(null);
  view?.select(id);
  state.panels.measure?.follow(id);
}

/** Shows the subject of a row of the explanation in the view, and leaves the other lists unchanged. */
export function lookAt(id) {
  state.selected = id;
  lists.why.open(id);
  view?.showRays(state.rays.get(id) ?? null, state.points.offset);
  view?.select(id);
}

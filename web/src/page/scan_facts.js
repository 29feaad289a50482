import { byId } from "../dom.js";
import { countWords, lengthWords, numbered, placeWords } from "../words.js";
import { state } from "./state.js";

/** Shows what is known of the scan; scene  of the answer, if there is one */
export function showScanFacts(scene) {
  const { scan, points, settings } = state;
  const facts = [
    points && numbered(points.total, "point", "points"),
    points &&
      points.total > points.positions.length / 3 &&
      `${countWords(points.positions.length / 3)} drawn`,
    scene?.invalid_points > 0 && `${countWords(scene.invalid_points)} invalid`,
    points?.viewpoint && `sensor at ${placeWords(points.viewpoint, settings.unit)}`,
    scene?.noise > 0 && `noise ${lengthWords(scene.noise, settings.unit)}`,
    scene?.view?.words,
  ];
  byId("scan-facts").textContent = facts.filter(Boolean).join(", ");
  byId("view-title").textContent = scan.name;
}

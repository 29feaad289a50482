/** The answer of a recognition, in the lists, the view and the panels. */
import { adviceView } from "../advice_view.js";
import { showAnswer } from "../answer.js";
import { detectionColors } from "../colors.js";
import { byId } from "../dom.js";
import { worthTelling } from "../rejected.js";
import { robotPoseView } from "../robot/pose_view.js";
import { timesView } from "../times.js";
import { numbered, rejectionWords, secondsWords } from "../words.js";
import { say } from "./headline.js";
import { isLayerShown, showLayer } from "./layers.js";
import { loadLibrary } from "./library.js";
import { drawPoses } from "./poses.js";
import { showScanFacts } from "./scan_facts.js";
import { lists } from "./selection.js";
import { state, view } from "./state.js";

const kSections = ["found", "rejected", "why", "times", "answer"];

export function clearResult() {
  const { session, robotPanel, measure } = state.panels;
  state.selected = null;
  session.leave();
  if (byId("problem").contains(document.activeElement)) byId("headline").focus();
  for (const id of ["problem", "advice"]) byId(id).replaceChildren();
  for (const id of kSections) byId(`${id}-section`).hidden = true;
  for (const list of Object.values(lists)) list.show([]);
  state.things = [];
  state.rays = new Map();
  robotPanel.show(null);
  measure?.setThings([]);
  view?.setThings([]);
}

/** What is listed and drawn of an answer: { found, rejected }. */
function thingsOf(detections, rejected) {
  const colors = detectionColors(detections);
  return {
    found: detections.map((pose, k) => ({
      id: `found-${k}`,
      kind: "found",
      label: `${k + 1}`,
      color: colors[k],
      pose,
    })),
    rejected: worthTelling(rejected, detections).map((pose, k) => ({
      id: `rejected-${k}`,
      kind: "rejected",
      label: `R${k + 1}`,
      pose,
      reason: rejectionWords(pose),
    })),
  };
}

function rejectedNote(all, listed) {
  if (!all) return "No other pose was tested in full.";
  if (all === listed) return "";
  return (
    `${numbered(all - listed, "more scores", "more score")} next to nothing, or lie where a better ` +
    "pose of the same model was found."
  );
}

function listThings({ found, rejected }, numRejected) {
  const { robot, robotPanel } = state.panels;
  const { scoreParts } = state;
  const { unit } = state.settings;
  const aboutPose = (pose) => robotPoseView(robot, pose, () => robotPanel.refresh());
  lists.found.show(found, { unit, scoreParts, aboutPose });
  lists.rejected.show(rejected, { unit, scoreParts });
  byId("found-section").hidden = !found.length;
  byId("rejected-note").textContent = rejectedNote(numRejected, rejected.length);
}

/** result  of service.recognize() */
export async function showResult(result, signal) {
  const { answer } = result;
  const [scene] = answer.scenes;
  if (answer.library.generation !== state.library.generation) await loadLibrary();
  const { detections, rejected = [] } = scene;
  const things = thingsOf(detections, rejected);
  const { scan, settings, library, panels } = state;
  say(
    detections.length
      ? `${detections.length} found in ${secondsWords(answer.seconds.work)}`
      : "No model found",
  );
  showScanFacts(scene);
  listThings(things, rejected.length);
  panels.robotPanel.show({ scene: scan.name, unit: settings.unit, detections }, library.models);
  showLayer("rejected", isLayerShown("rejected"));
  byId("advice").replaceChildren(...adviceView(scene.advice ?? []));
  byId("times").replaceChildren(...timesView(answer, result.seconds));
  byId("times-section").hidden = false;
  showAnswer(result, scan.name);
  state.things = [...things.found, ...things.rejected];
  await drawPoses(state.things, signal);
}

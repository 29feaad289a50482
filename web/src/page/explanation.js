/** Why models are found, or not, at a place of the scan. */
import { showCommands } from "../command_panel.js";
import { byId } from "../dom.js";
import * as service from "../service.js";
import { verdictWords } from "../why_list.js";
import { placeWords } from "../words.js";
import { setBusy } from "./headline.js";
import { drawPoses } from "./poses.js";
import { beginRequest, endRequest } from "./recognition.js";
import { lists, lookAt } from "./selection.js";
import { state } from "./state.js";

/** Asks why models are found, or not, at a position of the scan as drawn. */
export async function explainPlace(place) {
  const hasAnswer = state.things.length || !byId("times-section").hidden;
  if (!hasAnswer) return;
  const { scan, settings, library, points } = state;
  const request = beginRequest();
  const inScan = place.map((x, axis) => x + (points.offset[axis] ?? 0));
  byId("why-section").hidden = false;
  byId("why-note").textContent = `Looking at ${placeWords(inScan, settings.unit)} …`;
  lists.why.show([]);
  byId("why-section").scrollIntoView({ block: "nearest" });
  setBusy(true);
  try {
    const parameters = settings.parameters(scan);
    parameters.set("explain", inScan.join(","));
    showCommands(scan, parameters, library.library, settings.described);
    const { answer } = await service.recognize(scan, parameters, request.signal);
    await showExplanation(answer.scenes[0].explanation, request.signal);
  } catch (error) {
    if (!request.signal.aborted) byId("why-note").textContent = error.message;
  } finally {
    endRequest(request);
  }
}

async function showExplanation({ point, models }, signal) {
  const { settings } = state;
  const entries = models.map((explained, k) => {
    const found = explained.detection === null ? null : `found-${explained.detection}`;
    return { id: found ?? (explained.pose && `why-${k}`), explained };
  });
  byId("why-note").textContent =
    `At ${placeWords(point, settings.unit)}: ${verdictWords(models, settings.minScore)}`;
  lists.why.show(entries);
  state.rays = new Map(entries.map(({ id, explained }) => [id, explained.rays]));
  const drawn = entries
    .filter(({ id }) => id?.startsWith("why"))
    .map(({ id, explained }) => ({ id, kind: "why", label: "?", pose: explained.pose }));
  await drawPoses([...state.things, ...drawn], signal);
  lookAt(entries.find(({ id }) => id)?.id ?? null);
  byId("why-section").scrollIntoView({ block: "nearest" });
}

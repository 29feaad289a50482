/** Recognition of the current scan. */
import { showCommands } from "../command_panel.js";
import { byId } from "../dom.js";
import { unitThatFits } from "../extents.js";
import * as service from "../service.js";
import { lengthWords } from "../words.js";
import { say, setBusy, showProblem, tryAgain } from "./headline.js";
import { showTools } from "./layers.js";
import { besideOffset } from "./poses.js";
import { clearResult, showResult } from "./result.js";
import { showScanFacts } from "./scan_facts.js";
import { state, view } from "./state.js";

/** Makes a request the pending one; an earlier one is dropped. Returns its AbortController. */
export function beginRequest() {
  state.running?.abort();
  state.running = new AbortController();
  return state.running;
}

export function endRequest(request) {
  if (state.running === request) setBusy(false);
}

/** Shows the scan as read by the service, unless it is already shown. */
async function showPoints(signal) {
  const { scan, settings, limits, panels } = state;
  const parameters = settings.pointParameters(scan);
  const key = parameters.toString();
  if (state.points?.key === key) return;
  const points = { key, ...(await service.fetchPoints(scan, parameters, signal)) };
  state.points = points;
  view?.showScan(points.positions, points.viewpoint ? besideOffset(points.viewpoint) : [0, 0, 0]);
  panels.measure?.setScan(points, settings.unit);
  limits.setPoints(points);
  showTools();
  byId("canvas").setAttribute("aria-label", `Scan ${scan.name}`);
  showScanFacts();
}

/** Returns whether the settings are complete; otherwise shows what is missing. */
function checkSettings() {
  const { settings, scan } = state;
  const fault = settings.fault(scan);
  settings.mark(fault);
  showScanFacts();
  setBusy(!fault);
  if (!fault) return true;
  say("Settings are missing");
  showProblem(fault.message);
  return false;
}

/**
 * Requests recognition of the scan with the current settings, or shows a kept answer; a pending
 * request is dropped.
 */
export async function recognizeScan(kept = null) {
  const request = beginRequest();
  const { signal } = request;
  clearResult();
  if (!checkSettings()) return;
  const { scan, settings, library } = state;
  const { session } = state.panels;
  say(kept ? "Opening …" : "Recognizing …");
  let shown = Promise.resolve();
  const parameters = settings.parameters(scan);
  showCommands(scan, parameters, library.library, settings.described);
  try {
    scan.body ??= await service.fetchBytes(scan.url, signal);
    shown = showPoints(signal);
    const [result] = await Promise.all([
      kept ? service.keptResult(kept) : service.recognize(scan, parameters, signal),
      shown,
    ]);
    if (kept) session.enter(kept);
    await showResult(result, signal);
    if (kept && !signal.aborted) await session.show(kept);
  } catch (error) {
    // The points, if they come, may explain the error.
    await shown.catch(() => {});
    if (!signal.aborted) showFailure(error, kept);
  } finally {
    endRequest(request);
  }
}

function showFailure(error, kept) {
  say(error instanceof service.ServiceError ? "Not recognized" : "Not shown");
  if (proposeUnit()) return;
  showProblem(error.message, error.mayPass && tryAgain(() => recognizeScan(kept)));
}

/**
 * Proposes the other unit if the scan then matches the size of the models. Returns whether it does.
 */
function proposeUnit() {
  const { points, settings, library } = state;
  const found = unitThatFits(points?.positions, settings.unit, library);
  if (!found) return false;
  const { smallest, largest, fitting } = found;
  const across = Number(found.across.toPrecision(3));
  settings.markUnit();
  showProblem(
    `In ${settings.unit} the scan is ${across} ${settings.unit} across, the models ` +
      `${lengthWords(smallest, library.unit)} to ${lengthWords(largest, library.unit)}. ` +
      `It fits to them if its unit is ${fitting}: ${across} ${fitting} across.`,
    {
      label: `Read it in ${fitting}`,
      run: () => {
        settings.unit = fitting;
        recognizeScan();
      },
    },
  );
  return true;
}

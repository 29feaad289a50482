/** Opening of scans: dropped or chosen files, examples, kept answers, links. */
import { byId } from "../dom.js";
import { readLink, tellIgnored } from "../link.js";
import { mayBeDepthImage, readFiles, scanOfExample } from "../scan.js";
import { say, setBusy, showProblem, tryAgain } from "./headline.js";
import { showTools } from "./layers.js";
import { recognizeScan } from "./recognition.js";
import { clearResult } from "./result.js";
import { showScanFacts } from "./scan_facts.js";
import { state, view } from "./state.js";
import { showTab } from "./tabs.js";

/** Makes another scan the current one, before any of it is shown. */
function takeScan(next, camera) {
  state.scan = next;
  state.points = null;
  state.panels.measure?.setScan(null);
  state.limits.setPoints(null);
  view?.clear();
  byId("welcome").hidden = true;
  if (byId("examples-box").contains(document.activeElement)) byId("headline").focus();
  byId("examples-box").open = false;
  byId("recognize").disabled = false;
  state.settings.adopt(next, camera);
}

/**
 * answer  a kept answer, if there is one; otherwise the service is asked
 * linked  settings from the page's address, if it opens the scan
 */
export function openScan(next, camera, answer = null, linked = null) {
  takeScan(next, camera);
  const { settings } = state;
  const asked = answer?.query ? settings.shown(new URLSearchParams(answer.query)) : linked;
  tellIgnored(asked ? settings.restore(asked) : []);
  showTab("result");
  return recognizeScan(answer);
}

/** Shows a failed scan of the watched folder as a result; nothing of another scan stays. */
export function showFailedScan(failed, reason) {
  state.running?.abort();
  takeScan(failed, null);
  showTab("result");
  clearResult();
  showTools();
  setBusy(false);
  showScanFacts();
  say("Not recognized");
  showProblem(reason, tryAgain(() => recognizeScan()));
}

async function openScans({ scans, camera }) {
  const { session } = state.panels;
  if (session.isKept && (scans.length > 1 || (scans.length && !byId("session").hidden))) {
    showTab("session");
    return session.add(scans, camera);
  }
  if (scans.length > 1)
    throw new Error(`Expected one scan, found ${scans.length}: drop one at a time.`);
  if (scans.length) return openScan(scans[0], camera);
  state.settings.setCamera(camera);
  if (state.scan && mayBeDepthImage(state.scan)) return recognizeScan();
  return showProblem("The camera is kept for the next depth image.");
}

/** Opens files as parts to train while the models are shown, otherwise as scans. */
export async function openFiles(files) {
  const { partsPanel } = state.panels;
  if (partsPanel.allowed && !byId("models").hidden) return partsPanel.bring([...files]);
  try {
    return await openScans(await readFiles(files));
  } catch (error) {
    showTab("result");
    return showProblem(error.message);
  }
}

/** Applies the settings in the page's address, and opens the example in it. */
export function followLink(examples) {
  const { parameters, example: name } = readLink();
  const example = examples.find((one) => one.name === name);
  if (example && name !== state.scan?.name)
    return openScan(scanOfExample(example), null, null, parameters);
  const ignored = state.settings.restore(parameters);
  if (name && !example) ignored.push(`example: the service offers no “${name}”.`);
  tellIgnored(ignored);
  return state.scan && recognizeScan();
}

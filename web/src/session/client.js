/** The session that the service keeps: see /v1/openapi.json. */
import { ask, getJson } from "../service.js";

const kSession = "/v1/session";
const pathOf = (...names) => [kSession, ...names.map(encodeURIComponent)].join("/");

export const kArchive = pathOf("archive");
export const scanUrl = (name) => pathOf("scans", name);

const sendJson = async (path, value, signal) =>
  (await ask(path, { method: "PUT", body: JSON.stringify(value), signal })).json();

/**
 * { kept, unit, bytes: { used, allowed }, scans: [{ name, bytes, query, truth: poses, or null }],
 *   runs: [{ name, answers: [{ scan, found, seconds }] }], faults: [{ file, reason }] };
 * where the service keeps none, kept alone is there, and false
 */
export const fetchSession = () => getJson(kSession);

export const putScan = (name, parameters, body) =>
  ask(`${scanUrl(name)}?${parameters}`, { method: "PUT", body });
export const deleteScan = (name) => ask(scanUrl(name), { method: "DELETE" });
/** truth  [{ model, T_scene_model }]; returns the scan as the index has it */
export const putTruth = (name, truth) => sendJson(`${scanUrl(name)}/truth`, { truth });

export const fetchAnswer = (run, scan) => getJson(pathOf("runs", run, scan));
export const putAnswer = (run, scan, answer, signal) =>
  sendJson(pathOf("runs", run, scan), answer, signal);
export const deleteRun = (run) => ask(pathOf("runs", run), { method: "DELETE" });

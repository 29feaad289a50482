/** The session kept by the service: see /v1/openapi.json. */
import { ask, getJson } from "../service.js";

const kSession = "/v1/session";
const pathOf = (...names) => [kSession, ...names.map(encodeURIComponent)].join("/");

export const kArchive = pathOf("archive");
export const scanUrl = (name) => pathOf("scans", name);

/**
 * version  of the item to replace; none: any
 * Errors: ServiceError with status 409 and the current item, if its version differs.
 */
const sendJson = async (path, value, { signal, version } = {}) => {
  const headers = version ? { "If-Match": version } : {};
  return (await ask(path, { method: "PUT", body: JSON.stringify(value), headers, signal })).json();
};

/**
 * { kept, unit, bytes: { used, allowed }, scans: [{ name, bytes, query, truth: poses, or null,
 * version }], runs: [{ name, answers: [{ scan, found, seconds }] }], faults: [{ file, reason }] };
 * if the service keeps no session, only kept, which is false
 */
export const fetchSession = () => getJson(kSession);

export const putScan = (name, parameters, body) =>
  ask(`${scanUrl(name)}?${parameters}`, { method: "PUT", body });
export const deleteScan = (name) => ask(scanUrl(name), { method: "DELETE" });
/**
 * truth    [{ model, T_scene_model }]
 * version  of the scan when it was read; returns the scan's new entry in the index
 */
export const putTruth = (name, truth, version) =>
  sendJson(`${scanUrl(name)}/truth`, { truth }, { version });

/** { answer, version } */
export async function fetchAnswer(run, scan) {
  const response = await ask(pathOf("runs", run, scan));
  return { answer: await response.json(), version: response.headers.get("ETag") };
}
/** options  { signal, version: of the answer when it was read }; returns { run, scan, version } */
export const putAnswer = (run, scan, answer, options) =>
  sendJson(pathOf("runs", run, scan), answer, options);
export const deleteRun = (run) => ask(pathOf("runs", run), { method: "DELETE" });

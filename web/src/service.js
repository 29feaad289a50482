/** A refusal or missing response of the service, as a sentence for the user. */
export class ServiceError extends Error {
  /** status  of HTTP, 0: there was no response; told  the response, if it is JSON */
  constructor(message, status, told = {}) {
    super(message);
    this.status = status;
    this.told = told;
  }

  /** Whether the same request may succeed later. */
  get mayPass() {
    return this.status === 0 || this.status >= 500;
  }
}

const kHints = {
  413: "The file is larger than the service takes: ",
  503: "The service is busy: ",
  504: "The service took too long: ",
};

const kToken = "trivet-token";
// Whether the user was asked for a token and gave none.
let isTokenRefused = false;

/** The token required by the service; null: none was needed yet. */
function knownToken() {
  try {
    return sessionStorage.getItem(kToken);
  } catch {
    return null;
  }
}

function askForToken() {
  const token = isTokenRefused ? null : prompt("The service asks for a token:")?.trim();
  if (token) sessionStorage.setItem(kToken, token);
  isTokenRefused = !token;
  return token;
}

/** Like fetch, with a header that identifies the service's page, and a token if required. */
async function send(target, options) {
  for (;;) {
    const token = knownToken();
    const headers = { ...options.headers, "X-Trivet": "page" };
    if (token) headers.Authorization = `Bearer ${token}`;
    const response = await fetch(target, { ...options, headers });
    // Only the first of several refused requests asks for a token.
    if (response.status !== 401 || (knownToken() === token && !askForToken())) return response;
  }
}

/**
 * Sends every request of the page to the service.
 *
 * options  of fetch()
 * Errors: ServiceError; AbortError if the page itself stopped the request.
 */
export async function ask(target, options = {}) {
  let response;
  try {
    response = await send(target, options);
  } catch (error) {
    if (error.name === "AbortError") throw error;
    throw new ServiceError("The service does not answer. Is `trivet serve` still running?", 0);
  }
  if (response.ok) return response;
  let reason = response.statusText;
  let told = {};
  try {
    told = await response.json();
    reason = told.error ?? reason;
  } catch {
    // The response is not from the service but from a proxy, for example. Only the status is used.
  }
  const wait = response.headers.get("Retry-After");
  throw new ServiceError(
    `${kHints[response.status] ?? ""}${reason}${wait ? `. Try again in ${wait} s` : ""}.`,
    response.status,
    told,
  );
}

export const getJson = async (target, options) => (await ask(target, options)).json();

/** The time limit of requests that need no work. */
export const kQuickMs = 1200;
const quickly = () => ({ signal: AbortSignal.timeout(kQuickMs) });

/** Whether the service responds. Errors: it does not. */
export const askWhetherAlive = () => ask("/v2/health/live", quickly());

/**
 * { library, generation, unit,
 *   models: [{ name, diameter, symmetry: { poses, axis }, thumbnail, mesh,
 *     near_symmetry: { poses, axis, declaration: entries of a manifest, or null } }] }
 */
export const fetchLibrary = () => getJson("/v1/models");

/** [{ name, query: parameters to read it with, url }] */
export const fetchExamples = async () => (await getJson("/v1/examples")).examples;

/**
 * { watched, epoch: changes when numbers begin anew, scans: [{ number, name, query, time, seconds,
 * detections, error, url, answer: its address }] }, with numbers above `after`
 */
export const fetchLive = (after) => getJson(`/v1/live?after=${after}`, quickly());

/** An answer kept by the service at an address. */
export const fetchAnswer = getJson;

/** { bias, parts: [{ name, label, meaning, most_evidence }] }: see scoreBars */
export const fetchScoreParts = () => getJson("/v1/score-parts");

/**
 * The poses of detections for a robot: { poses: of each detection, [{ grasp, numbers: [{ name, value,
 * unit }] }], table: CSV, doubts: [{ about: "frame" or "grasps", model, length, unit, likelier }] }
 *
 * setup  { convention, scene: its name, unit: of the scan, frame: { name, T_robot_scene } or null,
 *        grasps: by model and name, detections }
 */
export const fetchRobotPoses = (setup) =>
  getJson("/v1/robot-poses", { method: "POST", body: JSON.stringify(setup) });

/** The parameters of recognition, as described by OpenAPI. */
export async function fetchParameters() {
  const { paths, components } = await getJson("/v1/openapi.json");
  return paths["/v1/recognize"].post.parameters.map(
    ({ $ref }) => components.parameters[$ref.split("/").pop()],
  );
}

/** The bytes at an address of the service. */
export async function fetchBytes(address, signal) {
  return (await ask(address, { signal })).arrayBuffer();
}

/**
 * Shows a picture of the service in an image element. The browser itself would request it without a
 * token.
 */
export function showPicture(image, address) {
  if (!knownToken()) {
    image.src = address;
    return image;
  }
  new IntersectionObserver(async (entries, observer) => {
    if (!entries.some(({ isIntersecting }) => isIntersecting)) return;
    observer.disconnect();
    image.onload = () => URL.revokeObjectURL(image.src);
    image.src = URL.createObjectURL(new Blob([await fetchBytes(address)]));
  }).observe(image);
  return image;
}

/**
 * { allowed, max_bytes, max_seconds, parts: [{ name, file, bytes, unit, state: "waiting",
 * "training", "trained" or "failed", seconds, error, facts: of a trained part, as in `trivet train
 * --json`, model: as in fetchLibrary, without a thumbnail }] }
 */
export const fetchParts = () => getJson("/v1/parts");

const change = async (method, path, parameters = {}, body = undefined) =>
  (await ask(`${path}?${new URLSearchParams(parameters)}`, { method, body })).json();
const partPath = (name) => `/v1/parts/${encodeURIComponent(name)}`;
// A model of an older library may have slashes in its name, which stay as they are.
const modelPath = (name) => `/v1/models/${name.split("/").map(encodeURIComponent).join("/")}`;

/** unit  of the file's coordinates */
export const bringPart = (name, file, unit) =>
  change("PUT", partPath(name), { file: file.name, unit }, file);
/** declaration  as in a manifest; null: the symmetry found by the service */
export const declarePart = (name, declaration) =>
  change("PATCH", partPath(name), {}, JSON.stringify({ declaration }));
/**
 * [{ motions, axis: { direction, point, turn_deg: null for any rotation }, deviation: { median,
 * p90, largest }, place: of the largest }], the near symmetries of a part or model
 */
const nearTurns = async (path) => (await getJson(`${path}/near-symmetry`)).turns;
export const fetchNearTurnsOfPart = (name) => nearTurns(partPath(name));
export const fetchNearTurnsOfModel = (name) => nearTurns(modelPath(name));
export const dropPart = (name) => change("DELETE", partPath(name));
export const publishPart = (name) => change("PUT", modelPath(name));
export const renameModel = (name, to) => change("PATCH", modelPath(name), { name: to });
export const removeModel = (name) => change("DELETE", modelPath(name));

/** A request about a scan, which the service calls "body". */
async function post(path, parameters, scan, signal) {
  try {
    return await ask(`${path}?${parameters}`, { method: "POST", body: scan.body, signal });
  } catch (error) {
    if (scan.name) error.message = error.message.replace(/^body\.\w+:/, `${scan.name}:`);
    throw error;
  }
}

/** Splits interleaved x, y, z, intensity into the positions and the intensities. */
function splitColumns(numbers) {
  const num = numbers.length / 4;
  const positions = new Float32Array(3 * num);
  const intensity = new Float32Array(num);
  for (let i = 0; i < num; ++i) {
    for (let k = 0; k < 3; ++k) positions[3 * i + k] = numbers[4 * i + k];
    intensity[i] = numbers[4 * i + 3];
  }
  return [positions, intensity];
}

/**
 * Points of a scan, thinned for drawing.
 *
 * Returns { positions: x, y, z of each in the scan's unit, offset: to be added for the scan's
 *   frame, total: before thinning, viewpoint: of the sensor in the scan's frame if known, else
 *   null, intensity: of each point if the scan has it, else null }.
 */
export async function fetchPoints(scan, parameters, signal) {
  const response = await post("/v1/points", `${parameters}&intensity=true`, scan, signal);
  const numbers = new Float32Array(await response.arrayBuffer());
  const isBright = response.headers.has("X-Columns");
  const [positions, intensity] = isBright ? splitColumns(numbers) : [numbers, null];
  const offset = (response.headers.get("X-Offset") ?? "0,0,0").split(",").map(Number);
  const viewpoint = response.headers.get("X-Viewpoint")?.split(",").map(Number) ?? null;
  const total = Number(response.headers.get("X-Points")) || positions.length / 3;
  return { positions, offset, total, viewpoint, intensity };
}

/**
 * Recognizes a scan.
 *
 * Returns { text: the response as received, answer: parsed, seconds: from sending the request to
 *   the end of the response }.
 */
export async function recognize(scan, parameters, signal) {
  performance.clearResourceTimings();
  const start = performance.now();
  const response = await post("/v1/recognize", parameters, scan, signal);
  const text = await response.text();
  // The network's time, if available: the page's time includes drawing in between.
  const sent = performance.getEntriesByName(response.url).at(-1);
  const ms = sent ? sent.responseEnd - sent.startTime : performance.now() - start;
  return { text, answer: JSON.parse(text), seconds: ms / 1000 };
}

/** A kept answer in the form returned by recognize(). */
export function keptResult(answer) {
  const { queue, work } = answer.seconds;
  return { text: JSON.stringify(answer), answer, seconds: queue + work };
}

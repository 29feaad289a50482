/** What the service refused, or that it did not answer, as a sentence for the user. */
export class ServiceError extends Error {
  /** status  of HTTP, 0: there was no answer; told  what else the answer says, if it is JSON */
  constructor(message, status, told = {}) {
    super(message);
    this.status = status;
    this.told = told;
  }

  /** Whether the same request may be answered another time. */
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
let isTokenRefused = false; // by who was asked for one

/** The token that the service asks for; null: none was asked for yet. */
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

/** As fetch, with what shows the service that its own page asks, and with a token if it wants one. */
async function send(target, options) {
  for (;;) {
    const token = knownToken();
    const headers = { ...options.headers, "X-Trivet": "page" };
    if (token) headers.Authorization = `Bearer ${token}`;
    const response = await fetch(target, { ...options, headers });
    // Of several requests that were refused the first asks.
    if (response.status !== 401 || (knownToken() === token && !askForToken())) return response;
  }
}

/**
 * All that the page asks of the service goes through here.
 *
 * options  of fetch()
 * Errors: ServiceError; AbortError, where the page itself stopped it.
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
    // Not of the service's own: a proxy's page, say. The status has to do.
  }
  const wait = response.headers.get("Retry-After");
  throw new ServiceError(
    `${kHints[response.status] ?? ""}${reason}${wait ? `. Try again in ${wait} s` : ""}.`,
    response.status,
    told,
  );
}

export const getJson = async (target, options) => (await ask(target, options)).json();

/** Within which what needs no work is answered. */
export const kQuickMs = 1200;
const quickly = () => ({ signal: AbortSignal.timeout(kQuickMs) });

/** Whether the service answers. Errors: it does not. */
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
 * { watched, epoch: another one where numbers begin anew, scans: [{ number, name, query, time,
 *   seconds, detections, error, url, answer: its address }] }, those of numbers above `after`
 */
export const fetchLive = (after) => getJson(`/v1/live?after=${after}`, quickly());

/** An answer that the service keeps at an address. */
export const fetchAnswer = getJson;

/** { bias, parts: [{ name, label, meaning, most_evidence }] }: see scoreBars */
export const fetchScoreParts = () => getJson("/v1/score-parts");

/** The parameters of a recognition, as OpenAPI describes them. */
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

/** Let an image show a picture of the service, which the browser would ask for without a token. */
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
 * { allowed, max_bytes, max_seconds, parts: [{ name, file, bytes, unit, state: "waiting", "training",
 *   "trained" or "failed", seconds, error, facts: of a trained one as `trivet train --json` has
 *   them, model: as of fetchLibrary, without a thumbnail }] }
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
/** declaration  as a manifest has it; null: what the service finds */
export const declarePart = (name, declaration) =>
  change("PATCH", partPath(name), {}, JSON.stringify({ declaration }));
/**
 * [{ motions, axis: { direction, point, turn_deg: null of any turn }, deviation: { median, p90,
 *   largest }, place: of the largest }] by what a part, or model, nearly looks the same
 */
const nearTurns = async (path) => (await getJson(`${path}/near-symmetry`)).turns;
export const fetchNearTurnsOfPart = (name) => nearTurns(partPath(name));
export const fetchNearTurnsOfModel = (name) => nearTurns(modelPath(name));
export const dropPart = (name) => change("DELETE", partPath(name));
export const publishPart = (name) => change("PUT", modelPath(name));
export const renameModel = (name, to) => change("PATCH", modelPath(name), { name: to });
export const removeModel = (name) => change("DELETE", modelPath(name));

/** A request about a scan, which the service knows as "body". */
async function post(path, parameters, scan, signal) {
  try {
    return await ask(`${path}?${parameters}`, { method: "POST", body: scan.body, signal });
  } catch (error) {
    if (scan.name) error.message = error.message.replace(/^body\.\w+:/, `${scan.name}:`);
    throw error;
  }
}

/** Of x, y, z, intensity after one another: the positions, and the intensities. */
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
 * Points of a scan, thinned to what can be drawn.
 *
 * Returns { positions: x, y, z of each in the scan's unit, offset: to be added for the scan's frame,
 *   total: before thinning, viewpoint: of the sensor in the scan's frame, where known, else null,
 *   intensity: of each point, if the scan has it, else null }.
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
 * Recognize a scan.
 *
 * Returns { text: the answer as it came, answer: parsed, seconds: from sending to the end of it }.
 */
export async function recognize(scan, parameters, signal) {
  performance.clearResourceTimings();
  const start = performance.now();
  const response = await post("/v1/recognize", parameters, scan, signal);
  const text = await response.text();
  // The network's clock, where there is one: the page's also counts what was drawn meanwhile.
  const sent = performance.getEntriesByName(response.url).at(-1);
  const ms = sent ? sent.responseEnd - sent.startTime : performance.now() - start;
  return { text, answer: JSON.parse(text), seconds: ms / 1000 };
}

/** An answer that is kept, as recognize() returns it. */
export function keptResult(answer) {
  const { queue, work } = answer.seconds;
  return { text: JSON.stringify(answer), answer, seconds: queue + work };
}

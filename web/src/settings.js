import { byId } from "./dom.js";
import { Options } from "./options.js";
import { kCameraKeys, isDepthImage, mayBeDepthImage } from "./scan.js";

const kRemembered = "trivet.settings"; // of files; examples bring their own
const kRejectedPerModel = 3;

const form = byId("settings");
const field = (name) => form.elements[name];
const kOfScan = ["unit", "viewpoint", ...kCameraKeys];

const triple = (text) => text.trim().split(/[\s,;]+/);
const isNumber = (text) => text.trim() !== "" && Number.isFinite(Number(text));

function remembered() {
  try {
    return JSON.parse(localStorage.getItem(kRemembered)) ?? {};
  } catch {
    return {}; // no storage, or not ours
  }
}

function remember(names) {
  try {
    const values = remembered();
    for (const name of names) values[name] = field(name).value;
    localStorage.setItem(kRemembered, JSON.stringify(values));
  } catch {
    // No storage: the next visit starts anew.
  }
}

/** What to ask for, and how the scan is to be read: the form, and what follows from it. */
export class Settings {
  #query = null; // of an example

  /**
   * unit        of the library, which a scan has unless it is said otherwise
   * parameters  of a recognition, as the service describes them
   */
  constructor(unit, parameters) {
    this.libraryUnit = unit;
    this.options = new Options(form, byId("options"), parameters);
    field("unit").value = remembered().unit || unit;
    form.addEventListener("change", () => this.#summarize());
    this.#summarize();
  }

  /** Take over how a scan is to be read: an example says it, a file is like the last one. */
  adopt(scan, camera) {
    const known = scan.query ? Object.fromEntries(scan.query) : remembered();
    const numbers = scan.query?.get("camera")?.split(",") ?? [];
    this.#query = scan.query;
    for (const name of kOfScan) field(name).value = known[name] ?? "";
    if (!field("unit").value) field("unit").value = this.libraryUnit;
    numbers.forEach((number, k) => (field(kCameraKeys[k]).value = number));
    if (scan.query?.has("method")) field("method").value = scan.query.get("method");
    if (scan.query?.has("min-score")) field("min-score").value = scan.query.get("min-score");
    byId("camera").hidden = !mayBeDepthImage(scan);
    if (camera) this.setCamera(camera);
    this.#summarize();
  }

  setCamera(camera) {
    for (const name of kCameraKeys) field(name).value = camera[name];
    remember(kCameraKeys);
  }

  get minScore() {
    return field("min-score").value;
  }

  get unit() {
    return field("unit").value;
  }

  set unit(unit) {
    field("unit").value = unit;
    this.#summarize();
  }

  /** Show that the unit is in doubt. */
  markUnit() {
    this.mark({ field: field("unit") });
  }

  /** The first field that cannot be sent, and what it needs: { field, message }; null: none. */
  fault(scan) {
    const wrong = (name, message) => ({ field: field(name), message });
    const score = Number(this.minScore);
    if (!isNumber(this.minScore) || score < 0 || score > 1) {
      return wrong("min-score", "Lowest score: expected a number from 0 to 1.");
    }
    const viewpoint = field("viewpoint").value.trim();
    if (viewpoint && !(triple(viewpoint).length === 3 && triple(viewpoint).every(isNumber))) {
      return wrong("viewpoint", "Sensor at: expected three numbers, as x, y, z.");
    }
    if (!isDepthImage(scan)) return null;
    const missing = kCameraKeys.find((name) => !isNumber(field(name).value));
    return missing
      ? wrong(
          missing,
          "A depth image needs its camera: give its five numbers, or drop a JSON file with them.",
        )
      : null;
  }

  /** Parameters of a request for this scan's points. */
  pointParameters(scan) {
    const parameters = new URLSearchParams(this.#query ?? []);
    parameters.set("format", scan.format);
    parameters.set("unit", this.unit);
    const viewpoint = field("viewpoint").value.trim();
    if (viewpoint) parameters.set("viewpoint", triple(viewpoint).join(","));
    else parameters.delete("viewpoint");
    const hasCamera = kCameraKeys.every((name) => isNumber(field(name).value));
    if (isDepthImage(scan) || (mayBeDepthImage(scan) && hasCamera)) {
      parameters.set("camera", kCameraKeys.map((name) => field(name).value.trim()).join(","));
    }
    return parameters;
  }

  /** Parameters of a request to recognize it. */
  parameters(scan) {
    const parameters = this.pointParameters(scan);
    parameters.set("method", field("method").value);
    parameters.set("min-score", this.minScore);
    parameters.set("rejected", kRejectedPerModel);
    for (const [name, value] of this.options.changed()) parameters.set(name, value);
    return parameters;
  }

  /** Show a fault, or its absence. */
  mark(fault) {
    for (const input of form.querySelectorAll("[aria-invalid]"))
      input.removeAttribute("aria-invalid");
    if (!fault) return;
    fault.field.setAttribute("aria-invalid", "true");
    byId("settings-box").open = true;
    fault.field.focus({ preventScroll: true }); // what is wrong is said above
    byId("headline").scrollIntoView({ block: "nearest" });
  }

  /** Call `run` when the user asks for another recognition. */
  onSubmit(run) {
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      if (!this.#query) remember(kOfScan);
      run();
    });
  }

  #summarize() {
    byId("settings-now").textContent =
      `${field("method").value}, score ≥ ${this.minScore}, ${this.unit}`;
  }
}

import { byId } from "./dom.js";
import { ChoiceField, NumberField } from "./options/fields.js";
import { Options } from "./options/options.js";
import { faultOf, isNumber, usualOf } from "./options/parameter.js";
import {
  kCameraKeys,
  kImageParameters,
  isDepthImage,
  isExample,
  mayBeDepthImage,
} from "./scan.js";
import { keep, recall } from "./storage.js";
import { numbered } from "./words.js";

// Settings of files are remembered; examples bring their own.
const kRemembered = "trivet.settings";
const kRejectedPerModel = 3;

const form = byId("settings");
const field = (name) => form.elements[name];
const kOfScan = ["unit", "viewpoint", ...kCameraKeys];
// The fields beside the options, whose values are always sent.
const kOwn = { method: ChoiceField, "min-score": NumberField };
// Parameters set by other fields of the form, or by the page itself.
const kReading = ["camera", ...kImageParameters, "viewpoint", "unit"];
const kElsewhere = ["format", ...kReading, "rejected", ...Object.keys(kOwn)];

const triple = (text) => text.trim().split(/[\s,;]+/);

function remembered() {
  try {
    return JSON.parse(recall(kRemembered)) ?? {};
  } catch {
    // The text is not from this page.
    return {};
  }
}

function remember(names, more = {}) {
  const values = { ...remembered(), ...more };
  for (const name of names) values[name] = field(name).value;
  keep(kRemembered, JSON.stringify(values));
}

/** The parameters of a request that concern the camera's images. */
const pick = (query) =>
  Object.fromEntries([...query].filter(([name]) => kImageParameters.includes(name)));

/** The settings of recognition and of reading the scan: the form and everything derived from it. */
export class Settings {
  // The query of an example.
  #query = null;
  // The properties of the camera's images, by parameter.
  #image = {};

  #onChange = () => {};

  /**
   * library     { unit, the default for scans; models }
   * parameters  of recognition, as described by the service
   */
  constructor({ unit, models }, parameters) {
    this.libraryUnit = unit;
    const inQuery = parameters.filter((parameter) => parameter.in === "query");
    this.described = new Map(inQuery.map((parameter) => [parameter.name, parameter]));
    for (const [name, Field] of Object.entries(kOwn)) {
      const { element } = new Field(this.described.get(name));
      element.required = field(name).required;
      field(name).replaceWith(element);
      field(name).value = this.#usual(name);
    }
    this.options = new Options(
      inQuery.filter(({ name }) => !kElsewhere.includes(name)),
      models.map(({ name }) => name),
      () => this.#changed(),
    );
    field("unit").value = remembered().unit || unit;
    form.addEventListener("input", () => this.#changed());
    this.#summarize();
  }

  /** Calls `act` whenever a setting changes. */
  onChange(act) {
    this.#onChange = act;
  }

  #changed() {
    this.#summarize();
    this.#onChange();
  }

  /** The default of a parameter; query  of the scan, or null */
  #usual(name, query = this.#query) {
    const own = { unit: this.libraryUnit }[name] ?? usualOf(this.described.get(name));
    return query?.get(name) ?? own;
  }

  /** Adopts how a scan is read: from an example, or for a file from the last file. */
  adopt(scan, camera) {
    const known = scan.query ? Object.fromEntries(scan.query) : remembered();
    const numbers = scan.query?.get("camera")?.split(",") ?? [];
    this.#query = scan.query;
    this.#image = scan.query ? pick(scan.query) : (known.image ?? {});
    for (const name of kOfScan) field(name).value = known[name] ?? "";
    if (!field("unit").value) field("unit").value = this.libraryUnit;
    numbers.forEach((number, k) => (field(kCameraKeys[k]).value = number));
    for (const name of Object.keys(kOwn)) {
      if (scan.query?.has(name)) field(name).value = scan.query.get(name);
    }
    byId("camera").hidden = !mayBeDepthImage(scan);
    if (camera) this.setCamera(camera);
    this.#changed();
  }

  /** The models of the library, which may have changed. */
  takeModels(models) {
    this.options.models = models.map(({ name }) => name);
  }

  setCamera(camera) {
    for (const name of kCameraKeys) field(name).value = camera[name];
    this.#image = camera.image ?? {};
    remember(kCameraKeys, { image: this.#image });
  }

  get minScore() {
    return field("min-score").value;
  }

  get unit() {
    return field("unit").value;
  }

  set unit(unit) {
    field("unit").value = unit;
    if (!this.#query) remember(["unit"]);
    this.#changed();
  }

  /** Show that the unit is in doubt. */
  markUnit() {
    this.mark({ field: field("unit") });
  }

  /** The first field with an invalid value, and the fix: { field, message }; null: none. */
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
    const option = this.options.fault();
    if (option || !isDepthImage(scan)) return option;
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
    if (isDepthImage(scan) || (mayBeDepthImage(scan) && this.#hasCamera)) {
      parameters.set("camera", this.#camera);
      for (const [name, value] of Object.entries(this.#image)) parameters.set(name, value);
    }
    return parameters;
  }

  get #camera() {
    return kCameraKeys.map((name) => field(name).value.trim()).join(",");
  }

  get #hasCamera() {
    return kCameraKeys.every((name) => isNumber(field(name).value));
  }

  /** Parameters of a request to recognize this scan. */
  parameters(scan) {
    const parameters = this.pointParameters(scan);
    parameters.set("method", field("method").value);
    parameters.set("min-score", this.minScore);
    parameters.set("rejected", kRejectedPerModel);
    for (const [name, value] of this.options.changed()) parameters.set(name, value);
    return parameters;
  }

  /** The parameters of an answered request that the form can show, for restore(). */
  shown(query) {
    const known = [...Object.keys(kOwn), ...kReading];
    return new URLSearchParams(
      [...query].filter(([name]) => known.includes(name) || this.options.get(name)),
    );
  }

  /** Parameters that differ from the default or from the example, for restore(). */
  shared(scan) {
    const parameters = new URLSearchParams();
    const query = isExample(scan) ? this.#query : null;
    const share = (name, value) => {
      if (value !== this.#usual(name, query)) parameters.set(name, value);
    };
    for (const name of [...Object.keys(kOwn), "unit"]) share(name, field(name).value);
    share("viewpoint", triple(field("viewpoint").value).join(","));
    if (scan && mayBeDepthImage(scan) && this.#hasCamera) {
      share("camera", this.#camera);
      for (const [name, value] of Object.entries(this.#image)) share(name, value);
    }
    for (const [name, value] of this.options.changed()) parameters.set(name, value);
    return parameters;
  }

  /** Sets these parameters and resets all others; returns a sentence on each that cannot be set. */
  restore(parameters) {
    this.options.reset();
    for (const name of Object.keys(kOwn)) field(name).value = this.#usual(name);
    const ignored = [];
    if (parameters.has("camera")) this.#image = {};
    for (const name of new Set(parameters.keys())) {
      const values = parameters.getAll(name);
      const wrong = values.length > 1 ? `${name}: expected once.` : this.#restore(name, values[0]);
      if (wrong) ignored.push(wrong);
    }
    if (!this.#query) {
      remember(["unit", "viewpoint"].filter((name) => parameters.has(name)));
      if (parameters.has("camera")) remember(kCameraKeys, { image: this.#image });
    }
    this.#changed();
    return ignored;
  }

  /** Returns the fault; null: none. */
  #restore(name, value) {
    const option = this.options.get(name);
    const known = this.described.get(name);
    const isOwn = Object.hasOwn(kOwn, name) || name === "unit";
    if (!option && !isOwn && !["viewpoint", "camera", ...kImageParameters].includes(name)) {
      return `${name}: nothing of this name can be set.`;
    }
    const isEmpty = name === "viewpoint" && value === "";
    const wrong = option ? option.faultOf(value) : isEmpty ? null : faultOf(known, value);
    if (wrong) return wrong;
    if (option) option.text = value;
    else if (name === "camera") {
      value.split(",").forEach((number, k) => (field(kCameraKeys[k]).value = number));
    } else if (kImageParameters.includes(name)) this.#image[name] = value;
    else field(name).value = value;
    return null;
  }

  /** Shows a fault, or clears it. */
  mark(fault) {
    for (const input of form.querySelectorAll("[aria-invalid]"))
      input.removeAttribute("aria-invalid");
    if (!fault) return;
    fault.field.setAttribute("aria-invalid", "true");
    byId("settings-box").open = true;
    this.options.open(fault.field);
    // The fault is described above the field, which is not to scroll away.
    fault.field.focus({ preventScroll: true });
    byId("headline").scrollIntoView({ block: "nearest" });
  }

  /** Calls `run` when the user requests another recognition. */
  onSubmit(run) {
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      if (!this.#query) remember(kOfScan);
      run();
    });
  }

  #summarize() {
    this.options.unit = this.unit;
    const count = this.options.changed().length;
    byId("settings-now").textContent =
      `${field("method").value}, score ≥ ${this.minScore}, ${this.unit}` +
      (count ? `, ${numbered(count, "option", "options")} changed` : "");
  }
}

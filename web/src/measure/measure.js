import { byId, element } from "../dom.js";
import { roundLength } from "../scale_bar.js";
import { kPalettes } from "../view/palettes.js";
import { lengthWords } from "../words.js";
import { showLegend } from "./legend.js";
import { measureDistances } from "./measure_distances.js";
import { resultsView } from "./results.js";
import { Ruler } from "./ruler.js";
import { heightsAlong, limitsOf, rangesFrom } from "./scan_values.js";
import { Section } from "./section.js";

// The choice of all models at once.
const kAll = "all";
// The largest tolerance if the user sets none, in diameters of the model.
const kTolerance = 0.01;
const kBandInTolerances = 5;
const kPerMillimeter = { m: 0.001, mm: 1 };
const kAxes = ["+x", "-x", "+y", "-y", "+z", "-z"];

const form = byId("measure");
const field = (name) => form.elements[name];

/** The colors, distances, sections and lengths that the user selects in a scan. */
export class Measure {
  #view;
  #section;
  // { positions, offset, viewpoint, intensity }
  #points = null;
  #unit = "m";
  // The detections as drawn.
  #things = [];
  #running = new AbortController();
  // The last measurement and its settings.
  #measured = null;

  ruler;

  constructor(view) {
    this.#view = view;
    this.#section = new Section(view, form);
    this.ruler = new Ruler(view);
    field("up").replaceChildren(
      ...kAxes.map((axis) => element("option", { value: axis }, axis.replace("-", "−"))),
    );
    form.addEventListener("submit", (event) => event.preventDefault());
    for (const name of ["color", "up", "target", "tolerance", "band"]) {
      field(name).addEventListener("change", () => this.#paint());
    }
  }

  /** points  of the service, as drawn; null: none yet; unit  of the scan */
  setScan(points, unit) {
    this.#points = points?.positions.length ? points : null;
    this.#unit = unit;
    byId("measure-box").hidden = !this.#points;
    this.setThings([]);
    if (!this.#points) return this.show(false);
    this.#section.setScan(points, unit);
    this.ruler.setScan(points, unit);
    const up = this.#view.up;
    const axis = up.findIndex((value) => Math.abs(value) > 0.5);
    field("up").value = `${up[axis] < 0 ? "-" : "+"}${"xyz"[axis]}`;
    this.#offer("range", points.viewpoint);
    this.#offer("intensity", points.intensity);
    return this.#paint();
  }

  /** Enables a color mode if its data exist. */
  #offer(mode, source) {
    field("color").querySelector(`[value=${mode}]`).disabled = !source;
    if (!source && field("color").value === mode) field("color").value = "plain";
  }

  /** things  the drawn detections: [{ id, label, name, geometry, pose }] */
  setThings(things) {
    this.#things = things;
    const before = field("target").value;
    field("target").replaceChildren(
      ...things.map(({ id, label, name }) => element("option", { value: id }, `${label} ${name}`)),
      element("option", { value: kAll }, "all that were found, the nearest"),
    );
    this.#aim(before);
    if (this.#points && field("color").value === "distance") this.#paint();
  }

  /** Measures distances to this detection, if it exists. */
  follow(id) {
    if (!this.#things.some((thing) => thing.id === id)) return;
    const before = field("target").value;
    this.#aim(id);
    const isOther = field("target").value !== before;
    if (isOther && field("color").value === "distance") this.#paint();
  }

  #aim(id) {
    field("target").value = this.#things.some((thing) => thing.id === id) ? id : kAll;
  }

  /** Whether the scan is shown instead of a single model. */
  show(shown) {
    byId("legend").hidden = !shown || !this.#points || field("color").value === "plain";
  }

  get #targets() {
    const chosen = field("target").value;
    return this.#things.filter(({ id }) => chosen === kAll || id === chosen);
  }

  /** { tolerance, band: in the unit of the scan, unit, fault: a sentence, or null } */
  #limits() {
    const perMillimeter = kPerMillimeter[this.#unit];
    const diameters = this.#targets.map(
      ({ geometry, pose }) => 2 * geometry.boundingSphere.radius * pose.getMaxScaleOnAxis(),
    );
    const usual = roundBelow((kTolerance * Math.max(...diameters)) / perMillimeter);
    field("tolerance").placeholder = String(usual);
    const tolerance = field("tolerance").value ? field("tolerance").valueAsNumber : usual;
    field("band").placeholder = String(Number((kBandInTolerances * tolerance).toPrecision(3)));
    const band = field("band").value ? field("band").valueAsNumber : kBandInTolerances * tolerance;
    const wrong = Object.entries({ tolerance, band }).find(([, value]) => !(value > 0));
    for (const name of ["tolerance", "band"]) {
      if (wrong?.[0] === name) field(name).setAttribute("aria-invalid", "true");
      else field(name).removeAttribute("aria-invalid");
    }
    const names = { tolerance: "Tolerance", band: "Points within" };
    return {
      tolerance: tolerance * perMillimeter,
      band: band * perMillimeter,
      unit: this.#unit,
      fault: wrong && `${names[wrong[0]]}: expected a length above 0 mm, found ${wrong[1]} mm.`,
    };
  }

  #paint() {
    this.#running.abort();
    const mode = field("color").value;
    byId("up-field").hidden = mode !== "height";
    byId("distance-fields").hidden = mode !== "distance";
    const [named] = field("color").selectedOptions;
    byId("measure-now").textContent = mode === "plain" ? "" : named.text;
    if (!this.#points) return undefined;
    this.show(!this.#view.showsModel);
    if (mode === "distance") return this.#paintDistances();
    if (mode === "plain") return this.#view.colorScan(null);
    const { values, title, words } = this.#valuesOf(mode);
    const { low, high } = limitsOf(values);
    const palette = kPalettes.length;
    const labels = [low, (low + high) / 2, high].map(words);
    showLegend({ title, labels, palette, hasBeyond: false });
    return this.#view.colorScan({ values, low, high, palette });
  }

  /** The values that color the points: { values: one per point, title, words: text of a value }. */
  #valuesOf(mode) {
    const { positions, offset, viewpoint, intensity } = this.#points;
    if (mode === "intensity") {
      const words = (value) => String(Number(value.toPrecision(3)));
      return { values: intensity, title: "intensity", words };
    }
    const words = (value) => lengthWords(value, this.#unit);
    if (mode === "range") {
      const place = viewpoint.map((x, axis) => x - offset[axis]);
      return { values: rangesFrom(positions, place), title: "distance from the sensor", words };
    }
    const [upwards] = field("up").selectedOptions;
    const values = heightsAlong(positions, field("up").value, offset);
    return { values, title: `height along ${upwards.text}`, words };
  }

  async #paintDistances() {
    const asking = new AbortController();
    this.#running = asking;
    const say = (text) => {
      this.show(false);
      this.#view.colorScan(null);
      byId("distances").replaceChildren(element("p", { role: "status" }, text));
    };
    const things = this.#targets;
    if (!things.length) return say("Nothing is found to measure to.");
    const limits = this.#limits();
    if (limits.fault) return say(limits.fault);
    const key = JSON.stringify([things.map(({ id, pose }) => [id, pose.elements]), limits.band]);
    if (this.#measured?.key !== key || this.#measured.positions !== this.#points.positions) {
      const { positions } = this.#points;
      this.#measured = null;
      say("Measuring …");
      try {
        const job = { positions, things, band: limits.band };
        const measured = await measureDistances(job, asking.signal, (done) => {
          if (!asking.signal.aborted) say(`Measuring … ${Math.round(100 * done)} %`);
        });
        if (asking.signal.aborted) return undefined;
        this.#measured = { ...measured, key, positions };
      } catch (error) {
        return say(error.message);
      }
    }
    return this.#showDistances(things, limits);
  }

  #showDistances(things, limits) {
    const { tolerance, unit } = limits;
    const palette = kPalettes.deviation;
    this.#view.colorScan(
      { values: this.#measured.distances, low: -tolerance, high: tolerance, palette },
      things.map(({ id }) => id),
    );
    const words = lengthWords(tolerance, unit);
    showLegend({
      title: `distance to ${things.length > 1 ? "models" : `${things[0].label} ${things[0].name}`}`,
      labels: [`−${words}`, "0", `+${words}`],
      palette,
      hasBeyond: true,
    });
    byId("distances").replaceChildren(...resultsView(this.#measured, limits));
    this.show(!this.#view.showsModel);
  }
}

/** The longest round length that is not above this one. */
const roundBelow = (length) => Number(roundLength(length / 120).toPrecision(1));

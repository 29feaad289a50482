import { byId } from "../dom.js";
import { lengthWords } from "../words.js";

const kAxes = { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] };

/** The smallest and largest coordinate of the positions along a direction. */
function rangeAlong(positions, [x, y, z]) {
  let [low, high] = [Infinity, -Infinity];
  for (let i = 0; i < positions.length; i += 3) {
    const at = x * positions[i] + y * positions[i + 1] + z * positions[i + 2];
    if (at < low) low = at;
    if (at > high) high = at;
  }
  return { low, high };
}

/** A slab to which the scan and its models are clipped, set by three fields of the form. */
export class Section {
  #view;
  #fields;
  #points = null;
  #unit = "m";
  #normal = null;
  #range = null;

  constructor(view, form) {
    this.#view = view;
    this.#fields = form.elements;
    this.#fields.section.addEventListener("change", () => this.#turn());
    byId("section-view").onclick = () => this.#turn();
    for (const name of ["section-at", "section-thickness"]) {
      this.#fields[name].addEventListener("input", () => this.#cut());
    }
  }

  /** points  { positions, offset }; unit  of the points */
  setScan(points, unit) {
    this.#points = points;
    this.#unit = unit;
    this.#fields.section.value = "";
    this.#turn();
  }

  #turn() {
    const across = this.#fields.section.value;
    this.#normal = across === "view" ? this.#view.forward : (kAxes[across] ?? null);
    byId("section-fields").hidden = !this.#normal;
    byId("section-view").hidden = across !== "view";
    if (this.#normal) this.#range = rangeAlong(this.#points.positions, this.#normal);
    this.#cut();
  }

  #cut() {
    if (!this.#normal) return this.#view.setSlab(null);
    const { low, high } = this.#range;
    const middle = low + (high - low) * this.#fields["section-at"].valueAsNumber;
    // Quadratic, so that thin slabs are set finely.
    const thickness = (high - low) * this.#fields["section-thickness"].valueAsNumber ** 2;
    const origin = this.#normal.reduce((sum, n, k) => sum + n * this.#points.offset[k], 0);
    this.#tell("section-at", lengthWords(middle + origin, this.#unit));
    this.#tell("section-thickness", lengthWords(thickness, this.#unit));
    return this.#view.setSlab({
      normal: this.#normal,
      low: middle - thickness / 2,
      high: middle + thickness / 2,
    });
  }

  #tell(name, words) {
    byId(`${name}-words`).textContent = words;
    this.#fields[name].setAttribute("aria-valuetext", words);
  }
}

/** The limits of poses, synchronized between the form and the view. */
import { Vector3 } from "three";

import { byId } from "./dom.js";
import { RegionGuide } from "./view/guides/region_guide.js";
import { TiltGuide } from "./view/guides/tilt_guide.js";

// Digits of a length after the point, by unit.
const kDigits = { m: 4, mm: 1 };
// The angle of a new limit [degrees].
const kUsualTilt = 30;
// The length of the arrow, in radii of the scan.
const kArrow = 0.4;

const numbers = (text) => text.split(",").map(Number);
const rounded = (value, digits) => String(Number(value.toFixed(digits)));

/** The bounding box of the points within the canvas: [low, high]; null: no point is. */
export function boxAround(positions, lens) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < positions.length; i += 3) {
    if (!lens.shows(positions[i], positions[i + 1], positions[i + 2])) continue;
    for (let axis = 0; axis < 3; ++axis) {
      low[axis] = Math.min(low[axis], positions[i + axis]);
      high[axis] = Math.max(high[axis], positions[i + axis]);
    }
  }
  return low[0] <= high[0] ? [new Vector3(...low), new Vector3(...high)] : null;
}

export class Limits {
  #settings;
  #region;
  #tilt;
  #lens = null;
  #points = null;

  constructor(settings) {
    this.#settings = settings;
    this.#region = new RegionGuide(byId("guides"), (box) => this.#setRegion(box));
    this.#tilt = new TiltGuide(byId("guides"), (tilt) => this.#setTilt(tilt));
  }

  /** points  { positions, offset } of the displayed scan, or null */
  setPoints(points) {
    this.#points = points;
    this.show();
  }

  /** lens  the projection of the scan to the canvas, or null */
  look(lens) {
    const isNew = Boolean(lens) !== Boolean(this.#lens);
    this.#lens = lens;
    if (isNew) this.show();
    this.#region.look(lens);
    this.#tilt.look(lens);
  }

  /** Draws the limits set in the form. */
  show() {
    byId("box").setAttribute("aria-pressed", this.#has("region"));
    byId("tilt").setAttribute("aria-pressed", this.#has("tilt"));
    const box = this.#box();
    this.#region.show(box);
    this.#tilt.show(this.#shownTilt(box));
  }

  /** Turns the limit of poses to the visible region on or off. */
  toggleRegion() {
    if (this.#has("region")) return this.#set("region", "");
    const box = this.#lens && this.#points && boxAround(this.#points.positions, this.#lens);
    return box && this.#setRegion(box);
  }

  /** Turns the limit of models to roughly upright in the view on or off. */
  toggleTilt() {
    if (this.#has("tilt")) return this.#set("tilt", "");
    return this.#lens && this.#setTilt({ direction: this.#lens.up, angle: kUsualTilt });
  }

  #has(name) {
    return this.#settings.options.get(name).text !== "";
  }

  /** The numbers of an option, or null if they are invalid. */
  #numbers(name) {
    const option = this.#settings.options.get(name);
    return option.isSet && !option.fault ? numbers(option.text) : null;
  }

  #set(name, text) {
    this.#settings.options.set(name, text);
  }

  #box() {
    const found = this.#points && this.#numbers("region");
    if (!found) return null;
    const offset = new Vector3(...this.#points.offset);
    return [0, 3].map((first) => new Vector3(...found.slice(first, first + 3)).sub(offset));
  }

  #setRegion(box) {
    const offset = new Vector3(...this.#points.offset);
    const digits = kDigits[this.#settings.unit];
    const texts = box.flatMap((corner) =>
      corner
        .clone()
        .add(offset)
        .toArray()
        .map((value) => rounded(value, digits)),
    );
    this.#set("region", texts.join(","));
  }

  #shownTilt(box) {
    const found = this.#points && this.#lens && this.#numbers("tilt");
    if (!found) return null;
    const at = box ? box[0].clone().add(box[1]).multiplyScalar(0.5) : this.#lens.center;
    const direction = new Vector3(...found.slice(3, 6));
    if (!direction.length()) return null;
    return { direction, angle: found[6], at, length: kArrow * this.#lens.radius };
  }

  #setTilt({ direction, angle }) {
    const ofModel = this.#numbers("tilt")?.slice(0, 3) ?? [0, 0, 1];
    const ofScan = direction.toArray().map((value) => rounded(value, 3));
    this.#set("tilt", [...ofModel, ...ofScan, rounded(angle, 0)].join(","));
  }
}

import { byId, element, terms } from "../dom.js";
import { lengthWords, pointWords } from "../words.js";

/** The distance between two points: { distance, along: [dx, dy, dz] }. */
export function between(from, to) {
  const along = to.map((value, axis) => value - from[axis]);
  return { distance: Math.hypot(...along), along };
}

/** A ruler between two points of the scan. */
export class Ruler {
  #view;
  #ends = [];
  #offset = [0, 0, 0];
  #unit = "m";

  constructor(view) {
    this.#view = view;
  }

  /** points  { offset }; unit  of the points */
  setScan({ offset }, unit) {
    this.#offset = offset;
    this.#unit = unit;
    this.clear();
  }

  clear() {
    this.#ends = [];
    this.#show();
  }

  /** Uses a drawn point of the scan as the next end; after two ends the ruler starts again. */
  take(point) {
    this.#ends = this.#ends.length === 1 ? [this.#ends[0], point] : [point];
    this.#show();
  }

  #show() {
    const unit = this.#unit;
    const [from, to] = this.#ends;
    const inScan = (point) => point.map((value, axis) => value + this.#offset[axis]);
    if (!to) {
      byId("ruler-figures").replaceChildren(
        element(
          "p",
          { className: "dim" },
          from
            ? `From ${pointWords(inScan(from), unit)} to the next place.`
            : "The button Ruler, then two places of the scan.",
        ),
      );
      return this.#view.setRuler(this.#ends, "");
    }
    const { distance, along } = between(from, to);
    const words = lengthWords(distance, unit);
    byId("ruler-figures").replaceChildren(
      terms([
        ["distance", element("b", {}, words)],
        ["dx, dy, dz", along.map((value) => lengthWords(value, unit)).join(", ")],
        ["from", pointWords(inScan(from), unit)],
        ["to", pointWords(inScan(to), unit)],
      ]),
    );
    return this.#view.setRuler(this.#ends, words);
  }
}

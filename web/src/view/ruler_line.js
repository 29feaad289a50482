import { Vector3 } from "three";

import { element } from "../dom.js";

const kSvg = "http://www.w3.org/2000/svg";
// The radius of the ends [pixel].
const kEnd = 4;

const svg = (tag, className) => {
  const made = document.createElementNS(kSvg, tag);
  made.setAttribute("class", className);
  return made;
};

/** A line between two positions, with its length beside the middle; drawn over everything. */
export class RulerLine {
  #svg = svg("svg", "ruler");
  #lines = [svg("line", "back"), svg("line", "front")];
  #ends = [svg("circle", "end"), svg("circle", "end")];
  #mark = element("span", { className: "mark ruler" });
  #places = [];

  constructor(marks) {
    this.#svg.append(...this.#lines, ...this.#ends);
    marks.append(this.#svg, this.#mark);
    this.set([], "");
  }

  /** places  positions in the world: none, one or two; text  shown with two */
  set(places, text) {
    this.#places = places;
    this.#mark.textContent = text;
  }

  /** Places it in a view of width x height pixels; isShown  whether it is visible at all */
  place(camera, width, height, isShown) {
    const seen = this.#places.map((place) => {
      const { x, y, z } = new Vector3().copy(place).project(camera);
      return { x: ((x + 1) / 2) * width, y: ((1 - y) / 2) * height, isAhead: Math.abs(z) < 1 };
    });
    const shows = isShown && seen.every(({ isAhead }) => isAhead);
    const isLine = shows && seen.length === 2;
    const set = (thing, attributes) => {
      for (const [name, value] of Object.entries(attributes)) {
        thing.setAttribute(name, typeof value === "number" ? value.toFixed(1) : value);
      }
    };
    const show = (thing, shown) => set(thing, { visibility: shown ? "visible" : "hidden" });
    this.#ends.forEach((end, k) => {
      show(end, shows && k < seen.length);
      if (seen[k]) set(end, { cx: seen[k].x, cy: seen[k].y, r: kEnd });
    });
    for (const line of this.#lines) {
      show(line, isLine);
      if (isLine) set(line, { x1: seen[0].x, y1: seen[0].y, x2: seen[1].x, y2: seen[1].y });
    }
    const { style } = this.#mark;
    style.visibility = isLine ? "visible" : "hidden";
    if (!isLine) return;
    const [x, y] = [(seen[0].x + seen[1].x) / 2, (seen[0].y + seen[1].y) / 2];
    style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(-50%, -50%)`;
  }
}

import { Vector3 } from "three";

import { Handle } from "./handle.js";
import { linesData, svg } from "./svg.js";

const kAxes = ["x", "y", "z"];
// In a view this much along an axis, the faces across it hide the effect of dragging them.
const kAlong = 0.03;

/** Corner k of a box: bit `axis` of k gives its side. */
const corner = ([low, high], k) =>
  new Vector3(...kAxes.map((axis, bit) => (k & (1 << bit) ? high : low)[axis]));

/** [corner, corner, axis of the edge] for the twelve edges. */
const kEdges = [0, 1, 2].flatMap((axis) =>
  [0, 1, 2, 3, 4, 5, 6, 7]
    .filter((k) => !(k & (1 << axis)))
    .map((k) => [k, k | (1 << axis), axis]),
);

/** The box that must contain all poses, with a handle on each face. */
export class RegionGuide {
  #front = svg("path", { class: "region" });
  #back = svg("path", { class: "region behind" });
  #handles;
  // [low, high], each a Vector3.
  #box = null;
  #lens = null;

  /** onDrag([low, high])  corners, in the frame of the lens */
  constructor(layer, onDrag) {
    layer.append(this.#back, this.#front);
    this.#handles = kAxes.flatMap((axis) =>
      [0, 1].map((side) => ({
        axis,
        side,
        handle: new Handle(layer, {
          title: `${side ? "to" : "from"} ${axis}`,
          label: axis,
          onDrag: (at) => onDrag(this.#dragged(axis, side, at)),
        }),
      })),
    );
  }

  /** box  [low, high], or null */
  show(box) {
    this.#box = box;
    this.#draw();
  }

  /** lens  or null: nothing is visible */
  look(lens) {
    this.#lens = lens;
    this.#draw();
  }

  #faceCenter(axis, side) {
    const [low, high] = this.#box;
    const center = low.clone().add(high).multiplyScalar(0.5);
    center[axis] = this.#box[side][axis];
    return center;
  }

  /** Whether the eye is in front of a face, outside the box. */
  #isBefore(axis, side) {
    const beyond = this.#lens.eye[axis] - this.#box[side][axis];
    return side ? beyond > 0 : beyond < 0;
  }

  /** The box with a face moved along its axis to the point nearest to the pointer's ray. */
  #dragged(axis, side, at) {
    const { origin, direction } = this.#lens.ray(at.x, at.y);
    const base = this.#faceCenter(axis, side);
    const offset = base.clone().sub(origin);
    const cosine = direction[axis];
    const moved = (offset.dot(direction) * cosine - offset[axis]) / (1 - cosine * cosine);
    const box = this.#box.map((place) => place.clone());
    const limit = box[1 - side][axis];
    const value = base[axis] + moved;
    box[side][axis] = side ? Math.max(value, limit) : Math.min(value, limit);
    return box;
  }

  #draw() {
    const isSeen = Boolean(this.#box && this.#lens);
    const lines = { front: [], back: [] };
    if (isSeen) {
      for (const [from, to, along] of kEdges) {
        const faces = kAxes.filter((_, axis) => axis !== along);
        const isFront = faces.some((axis) => this.#isBefore(axis, (from >> kAxes.indexOf(axis)) & 1));
        lines[isFront ? "front" : "back"].push(
          this.#lens.line(corner(this.#box, from), corner(this.#box, to)),
        );
      }
    }
    this.#front.setAttribute("d", linesData(lines.front));
    this.#back.setAttribute("d", linesData(lines.back));
    for (const { axis, side, handle } of this.#handles) {
      if (!isSeen) {
        handle.place(null);
        continue;
      }
      const center = this.#faceCenter(axis, side);
      const toFace = center.clone().sub(this.#lens.eye).normalize();
      const isAlong = 1 - toFace[axis] ** 2 < kAlong;
      handle.place(isAlong ? null : this.#lens.project(center), !this.#isBefore(axis, side));
    }
  }
}

import { Vector3 } from "three";

import { Handle } from "./handle.js";
import { linesData, svg } from "./svg.js";

// The number of steps of the rim.
const kSteps = 48;
const kSpokes = 8;
const kDegrees = 180 / Math.PI;

/** The reference direction for the tilt of models as an arrow, and the largest tilt as a cone. */
export class TiltGuide {
  #arrow = svg("path", { class: "tilt" });
  #cone = svg("path", { class: "tilt limit" });
  #tip;
  #rim;
  // { direction: unit Vector3, angle [degrees], at: Vector3, length }
  #tilt = null;
  // The side of the cone with its handle: unit Vector3.
  #side = null;
  // Whether the dragged handle is on the far side of the sphere.
  #isFar = false;
  #lens = null;

  /** onDrag({ direction, angle })  in the frame of the lens */
  constructor(layer, onDrag) {
    layer.append(this.#cone, this.#arrow);
    this.#tip = new Handle(layer, {
      title: "direction of the limit",
      onStart: () => this.#grab(this.#tilt.direction),
      onDrag: (at) => onDrag({ direction: this.#pointed(at), angle: this.#tilt.angle }),
    });
    this.#rim = new Handle(layer, {
      title: "angle of the limit",
      onStart: () => this.#grab(this.#onRim(this.#side)),
      onDrag: (at) => {
        const { direction } = this.#tilt;
        const pointed = this.#pointed(at);
        const across = pointed.clone().addScaledVector(direction, -pointed.dot(direction));
        if (across.length() > 1e-6) this.#side = across.normalize();
        onDrag({ direction, angle: kDegrees * direction.angleTo(pointed) });
      },
    });
  }

  /** tilt  { direction: of any length, angle, at: start of the arrow, length }, or null */
  show(tilt) {
    this.#tilt = tilt && { ...tilt, direction: tilt.direction.clone().normalize() };
    this.#draw();
  }

  /** lens  or null: nothing is visible */
  look(lens) {
    this.#lens = lens;
    this.#draw();
  }

  /** The unit vector to the rim of the cone on a given side. */
  #onRim(side) {
    const { direction, angle } = this.#tilt;
    const turn = angle / kDegrees;
    return direction.clone().multiplyScalar(Math.cos(turn)).addScaledVector(side, Math.sin(turn));
  }

  #place(unit) {
    return this.#tilt.at.clone().addScaledVector(unit, this.#tilt.length);
  }

  #grab(unit) {
    this.#isFar = unit.dot(this.#lens.eye.clone().sub(this.#place(unit))) < 0;
  }

  /**
   * The direction from the arrow's start to the point of the surrounding sphere under the pointer.
   */
  #pointed({ x, y }) {
    const { at, length } = this.#tilt;
    const ray = this.#lens.ray(x, y);
    const nearest = ray.closestPointToPoint(at, new Vector3());
    const aside = nearest.distanceTo(at);
    if (aside < length) {
      const half = Math.sqrt(length * length - aside * aside);
      nearest.addScaledVector(ray.direction, this.#isFar ? half : -half);
    }
    return nearest.sub(at).normalize();
  }

  /** A side of the cone: the one dragged last, else the rightmost in the view. */
  #chooseSide() {
    const { direction, at } = this.#tilt;
    const right = new Vector3().crossVectors(at.clone().sub(this.#lens.eye), direction);
    const side = this.#side ?? right;
    side.addScaledVector(direction, -side.dot(direction));
    if (side.length() < 1e-6) side.set(direction.y, direction.z, direction.x).cross(direction);
    this.#side = side.normalize();
  }

  #draw() {
    const isSeen = Boolean(this.#tilt && this.#lens);
    const arrow = [];
    const cone = [];
    if (isSeen) {
      this.#chooseSide();
      const { at, direction, length } = this.#tilt;
      const up = new Vector3().crossVectors(direction, this.#side);
      const rim = Array.from({ length: kSteps }, (_, k) => {
        const turn = (2 * Math.PI * k) / kSteps;
        const side = this.#side.clone().multiplyScalar(Math.cos(turn));
        return this.#place(this.#onRim(side.addScaledVector(up, Math.sin(turn))));
      });
      rim.forEach((place, k) => {
        cone.push(this.#lens.line(place, rim[(k + 1) % kSteps]));
        if (k % (kSteps / kSpokes) === 0) cone.push(this.#lens.line(at, place));
      });
      const tip = this.#place(direction);
      arrow.push(this.#lens.line(at, tip));
      for (const sign of [-1, 1]) {
        const barb = at.clone().addScaledVector(direction, 0.88 * length);
        arrow.push(this.#lens.line(tip, barb.addScaledVector(this.#side, 0.05 * sign * length)));
      }
    }
    this.#arrow.setAttribute("d", linesData(arrow));
    this.#cone.setAttribute("d", linesData(cone));
    this.#tip.place(isSeen ? this.#lens.project(this.#place(this.#tilt.direction)) : null);
    this.#rim.place(isSeen ? this.#lens.project(this.#place(this.#onRim(this.#side))) : null);
  }
}

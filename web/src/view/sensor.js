import { BufferGeometry, LineBasicMaterial, LineSegments, Matrix4, Vector3 } from "three";

import { element } from "../dom.js";

// The size of the pyramid, in radii of the scan.
const kSize = 0.16;
// Within this angle the view is that of the sensor.
const kSameDirection = Math.cos((8 * Math.PI) / 180);
// The distance of a mark from the border of the view [pixel].
const kMargin = 34;
const kArrows = ["→", "↗", "↑", "↖", "←", "↙", "↓", "↘"];

/** A pyramid from the sensor along its view direction. */
function makePyramid() {
  const apex = [0, 0, 0];
  const corners = [
    [-0.5, -0.4, 1],
    [0.5, -0.4, 1],
    [0.5, 0.4, 1],
    [-0.5, 0.4, 1],
  ];
  const lines = corners.flatMap((corner, k) => [apex, corner, corner, corners[(k + 1) % 4]]);
  const geometry = new BufferGeometry().setFromPoints(lines.map((at) => new Vector3(...at)));
  const pyramid = new LineSegments(geometry, new LineBasicMaterial());
  pyramid.matrixAutoUpdate = false;
  pyramid.frustumCulled = false;
  return pyramid;
}

/** The position of the sensor, with a mark that points to it if it is outside the view. */
export class Sensor {
  pyramid = makePyramid();
  #mark = element("span", { className: "mark sensor", hidden: true }, "sensor");
  #at = null;

  constructor(marks) {
    marks.append(this.#mark);
    this.show(null);
  }

  /** at  in the world, facing the world's origin; null: no sensor, or it must be hidden */
  show(at) {
    this.#at = at;
    this.pyramid.visible = Boolean(at);
    this.#mark.hidden = !at;
    if (!at) return;
    const towards = at.clone().negate().normalize();
    const up = Math.abs(towards.y) > 0.99 ? new Vector3(1, 0, 0) : new Vector3(0, 1, 0);
    const right = new Vector3().crossVectors(up, towards).normalize();
    this.pyramid.matrix
      .makeBasis(right, new Vector3().crossVectors(towards, right), towards)
      .scale(new Vector3().setScalar(kSize))
      .copyPosition(new Matrix4().makeTranslation(at));
  }

  setColor(color) {
    this.pyramid.material.color.copy(color);
  }

  /** Called before drawing: in the sensor's view the pyramid would only be in the way. */
  prepare(camera, target) {
    if (!this.#at) return;
    const look = camera.position.clone().sub(target).normalize();
    const isOwnView = look.dot(this.#at.clone().normalize()) > kSameDirection;
    this.#mark.hidden = isOwnView;
    this.pyramid.visible = !isOwnView;
  }

  /** Called after drawing: places the mark in a view of width x height pixels. */
  place(camera, width, height) {
    if (this.#mark.hidden) return;
    const seen = this.#at.clone().applyMatrix4(camera.matrixWorldInverse);
    const isAhead = seen.z < -camera.near;
    const point = this.#at.clone().project(camera);
    const inView = isAhead && Math.max(Math.abs(point.x), Math.abs(point.y)) < 0.95;
    // These are in half pixels from the middle.
    let [across, up] = [point.x * width, point.y * height];
    let text = "sensor";
    if (!inView) {
      [across, up] = [seen.x, seen.y];
      const room = [Math.max(1, width - 2 * kMargin), Math.max(1, height - 2 * kMargin)];
      const reach = Math.max(Math.abs(across) / room[0], Math.abs(up) / room[1]) || 1;
      text += ` ${kArrows[Math.round((4 * Math.atan2(up, across)) / Math.PI + 8) % 8]}`;
      [across, up] = [across / reach, up / reach];
    }
    this.#mark.textContent = text;
    const { style } = this.#mark;
    style.visibility = "visible";
    style.transform =
      `translate(${((width + across) / 2).toFixed(1)}px, ${((height - up) / 2).toFixed(1)}px) ` +
      "translate(-50%, -50%)";
  }
}

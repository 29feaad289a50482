import { Matrix4, Vector3 } from "three";

import { frameOf } from "./frame.js";
import { pickPoint } from "./pick_point.js";
import { colorScanPoints, makeScanPoints } from "./scan_points.js";

// Points that do not count are mixed with this share of the ground's color.
const kDim = 0.8;

/** The points of a scan in a scene, and its frame; without a scan, both are null. */
export class ScanCloud {
  #scene;
  #frame = null;
  #points = null;

  constructor(scene) {
    this.#scene = scene;
  }

  get frame() {
    return this.#frame;
  }

  /** The typical distance between neighboring points in the world; 0 without a scan. */
  get spacing() {
    return this.#points?.material.uniforms.spacing.value ?? 0;
  }

  /** positions  x, y, z of each point; viewpoint  of the sensor; both in the scan's frame */
  show(positions, viewpoint) {
    this.#frame = frameOf(positions, viewpoint);
    this.#points = makeScanPoints(positions, this.#frame);
    this.#scene.add(this.#points);
  }

  clear() {
    this.#points?.removeFromParent();
    this.#points?.geometry.dispose();
    this.#points?.material.uniforms.palette.value.dispose();
    this.#points?.material.dispose();
    this.#points = null;
    this.#frame = null;
  }

  /** Colors the points that have no color of their own; ground  the color behind them */
  ink(color, ground) {
    if (!this.#points) return;
    const { uniforms } = this.#points.material;
    uniforms.color.value = color;
    uniforms.dim.value = color.clone().lerp(ground, kDim);
  }

  /** See colorScanPoints. */
  color(coloring) {
    colorScanPoints(this.#points, coloring);
  }

  /** planes  of the section */
  arrange(visible, planes) {
    if (!this.#points) return;
    this.#points.visible = visible;
    this.#points.material.clippingPlanes = planes;
  }

  /** smallest  size of a point; pixelsPerUnit  of something at distance 1 [pixel] */
  setPointSize(smallest, pixelsPerUnit) {
    if (!this.#points) return;
    const { uniforms } = this.#points.material;
    uniforms.pixelsPerUnit.value = pixelsPerUnit;
    uniforms.smallest.value = smallest;
  }

  /**
   * The visible point at a position of the canvas, in the scan's frame, or null.
   *
   * isLeft(place)  whether the section keeps a position of the world
   */
  pointAt([x, y], canvas, camera, isLeft) {
    const project = new Matrix4()
      .multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse)
      .multiply(this.#points.matrix);
    const centered = this.#points.geometry.getAttribute("position").array;
    const isSeen = (at) => isLeft(new Vector3(...at).applyMatrix4(this.#points.matrix));
    const { clientWidth: width, clientHeight: height } = canvas;
    const point = pickPoint(centered, project, { x, y, width, height }, isSeen);
    return point && this.#frame.center.clone().add(new Vector3(...point)).toArray();
  }
}

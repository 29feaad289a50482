import { DoubleSide, Mesh, MeshLambertMaterial } from "three";

import { frameOf } from "./frame.js";
import { freeMaterials } from "./materials.js";
import { makeTurnAxes } from "./turn_axes.js";
import { makeTurned } from "./turned_model.js";

/** A model shown by itself, in a frame of its own. */
export class SingleModel {
  #mesh;
  #frame;

  /**
   * symmetry  { axes: see makeTurnAxes, turned: an object drawn over the model, or null: see
   *           makeTurned }
   * colors    { model, axes, turned }
   */
  constructor(geometry, { axes, turned }, colors) {
    const material = new MeshLambertMaterial({
      color: colors.model,
      flatShading: true,
      side: DoubleSide,
    });
    this.#mesh = new Mesh(geometry, material);
    this.#frame = frameOf(geometry.attributes.position.array, null);
    this.#mesh.matrixAutoUpdate = false;
    this.#mesh.matrix.copy(this.#frame.toWorld);
    this.#mesh.add(makeTurnAxes(axes, this.#frame.radius, colors.axes));
    if (turned) this.#mesh.add(makeTurned(geometry, turned, this.#frame.radius, colors.turned));
  }

  get mesh() {
    return this.#mesh;
  }

  get frame() {
    return this.#frame;
  }

  /** Removes the model and frees all but its geometry, which is reused. */
  dispose() {
    this.#mesh.removeFromParent();
    freeMaterials(this.#mesh);
    this.#mesh.traverse(
      ({ geometry }) => geometry !== this.#mesh.geometry && geometry?.dispose(),
    );
  }
}

import { PLYLoader } from "three/examples/jsm/loaders/PLYLoader.js";

import { fetchBytes } from "../service.js";

/** Meshes of the library's models, fetched on first use and freed when no longer needed. */
export class Meshes {
  #addresses = new Map();
  #geometries = new Map();

  /** Sets the models of another library and frees the meshes of the last one. */
  setModels(models) {
    this.keep(new Set());
    this.#addresses = new Map(models.map((model) => [model.name, model.mesh]));
  }

  /** The geometry of a model in the library's unit; errors: ServiceError. */
  get(name) {
    if (!this.#geometries.has(name)) {
      const made = fetchBytes(this.#addresses.get(name)).then((bytes) => {
        const geometry = new PLYLoader().parse(bytes);
        geometry.computeBoundingBox();
        geometry.computeBoundingSphere();
        return geometry;
      });
      this.#geometries.set(name, made);
      made.catch(() => this.#geometries.delete(name));
    }
    return this.#geometries.get(name);
  }

  /** Frees all others. */
  keep(names) {
    for (const [name, made] of this.#geometries) {
      if (names.has(name)) continue;
      this.#geometries.delete(name);
      made.then(
        (geometry) => geometry.dispose(),
        () => {},
      );
    }
  }
}

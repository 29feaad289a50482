import { Color, NearestFilter, Raycaster, Vector2, WebGLRenderTarget } from "three";

import { outlineMaterial } from "./picture.js";

// The width of the picture that is searched [pixel].
const kWidth = 256;
// The number of things that a byte distinguishes.
const kMost = 255;

/**
 * For each of `count` things the pixel farthest from other things and from the border, in steps to
 * the four neighbors; -1 if it has none.
 *
 * ids  row by row: 1 for the first thing, 0 for none
 * Source: Rosenfeld and Pfaltz, J. ACM 1966: one pass down, one up.
 */
export function innermostPixels(ids, width, count) {
  const depth = new Uint16Array(ids.length);
  const beyond = (pixel, isInside, other) =>
    isInside && ids[other] === ids[pixel] ? depth[other] : 0;
  for (let i = 0; i < ids.length; ++i) {
    const left = beyond(i, i % width > 0, i - 1);
    depth[i] = 1 + Math.min(left, beyond(i, i >= width, i - width));
  }
  const found = new Array(count).fill(-1);
  for (let i = ids.length - 1; i >= 0; --i) {
    const right = beyond(i, (i + 1) % width > 0, i + 1);
    const below = beyond(i, i + width < ids.length, i + width);
    depth[i] = Math.min(depth[i], 1 + Math.min(right, below));
    const thing = ids[i] - 1;
    if (thing < 0 || thing >= count) continue;
    if (found[thing] < 0 || depth[i] > depth[found[thing]]) found[thing] = i;
  }
  return found;
}

/** Finds positions on visible parts of meshes, where a label is unambiguous. */
export class SeenParts {
  #target = new WebGLRenderTarget(1, 1, { minFilter: NearestFilter, magFilter: NearestFilter });
  #materials = [];

  /**
   * scene   contains the visible meshes, and everything that may hide them
   * isSeen  whether a hit of a ray is visible, and not clipped
   * shrink  called with the height of the picture drawn for this [pixel]
   * The picture is drawn at once, and its pixels are read asynchronously. Promises a position on
   * the surface of each mesh, in the world; null where nothing of it is visible.
   */
  async find(renderer, scene, camera, meshes, isSeen, shrink) {
    const height = Math.max(1, Math.round(kWidth / camera.aspect));
    this.#target.setSize(kWidth, height);
    shrink(height);
    // The matrix is otherwise that of the previous picture.
    camera.updateMatrixWorld();
    const seenFrom = camera.clone();
    const pixels = await this.#draw(renderer, scene, camera, meshes.slice(0, kMost), height);
    const ids = new Uint8Array(kWidth * height).map((_, i) => pixels[4 * i + 3]);
    const caster = new Raycaster();
    const places = innermostPixels(ids, kWidth, meshes.length);
    return places.map((pixel, k) => {
      if (pixel < 0) return null;
      const across = (2 * ((pixel % kWidth) + 0.5)) / kWidth - 1;
      const up = (2 * (Math.floor(pixel / kWidth) + 0.5)) / height - 1;
      caster.setFromCamera(new Vector2(across, up), seenFrom);
      return caster.intersectObject(meshes[k], false).find(isSeen)?.point ?? null;
    });
  }

  #draw(renderer, scene, camera, meshes, height) {
    const [background, materials] = [scene.background, meshes.map(({ material }) => material)];
    scene.background = null;
    meshes.forEach((mesh, k) => {
      mesh.material = this.#materials[k] ??= outlineMaterial(k + 1, new Color());
      mesh.material.clippingPlanes = materials[k].clippingPlanes;
    });
    renderer.setRenderTarget(this.#target);
    renderer.setClearColor(0, 0);
    renderer.clear();
    renderer.render(scene, camera);
    const pixels = new Uint8Array(4 * kWidth * height);
    const read = renderer.readRenderTargetPixelsAsync(this.#target, 0, 0, kWidth, height, pixels);
    renderer.setRenderTarget(null);
    meshes.forEach((mesh, k) => (mesh.material = materials[k]));
    scene.background = background;
    return read;
  }
}

import { Plane, Vector3 } from "three";

/**
 * The clipping planes that keep a slab.
 *
 * slab     { normal: unit vector, low, high: along it }, in a frame; null: everything is kept
 * toWorld  of that frame, a similarity
 */
export function planesOf(slab, toWorld) {
  if (!slab) return [];
  const normal = new Vector3(...slab.normal);
  const planes = [new Plane(normal, -slab.low), new Plane(normal.clone().negate(), slab.high)];
  return planes.map((plane) => plane.applyMatrix4(toWorld));
}

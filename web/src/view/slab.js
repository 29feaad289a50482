import { Plane, Vector3 } from "three";

/**
 * The planes that leave a slab, to clip by.
 *
 * slab     { normal: unit vector, low, high: along it }, in a frame; null: all is left
 * toWorld  of that frame, a similarity
 */
export function planesOf(slab, toWorld) {
  if (!slab) return [];
  const normal = new Vector3(...slab.normal);
  const planes = [new Plane(normal, -slab.low), new Plane(normal.clone().negate(), slab.high)];
  return planes.map((plane) => plane.applyMatrix4(toWorld));
}

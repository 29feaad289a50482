import { BufferAttribute, BufferGeometry, Color, Matrix4, Points, PointsMaterial } from "three";

import { kVerdicts } from "../rays.js";

// The size of a point, in sides of the square that each would have of the points' extent.
const kSize = 1.3;

/**
 * The verdicts of rays for a posed model, as colored points on it.
 *
 * rays    by verdict, x, y, z of each hit in the frame of the scan's file
 * offset  of the scan's points as drawn
 * frame   of the scan's points
 */
export function makeRayPoints(rays, offset, frame) {
  const told = kVerdicts.filter(({ name }) => rays[name].length);
  const colors = told.flatMap(({ name, color }) =>
    new Array(rays[name].length / 3).fill(new Color(color).toArray()).flat(),
  );
  const { center, radius, toWorld } = frame;
  const origin = center.toArray().map((x, axis) => x + offset[axis]);
  const places = told.flatMap(({ name }) => rays[name]).map((x, k) => x - origin[k % 3]);
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(places), 3));
  geometry.setAttribute("color", new BufferAttribute(new Float32Array(colors), 3));
  geometry.computeBoundingSphere();
  const across = (2 * geometry.boundingSphere.radius) / radius;
  const size = (kSize * across) / Math.sqrt(places.length / 3);
  const points = new Points(geometry, new PointsMaterial({ size, vertexColors: true }));
  points.frustumCulled = false;
  points.matrixAutoUpdate = false;
  points.matrix.copy(toWorld).multiply(new Matrix4().makeTranslation(center));
  return points;
}

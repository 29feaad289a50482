/** The model properties used to compare poses: see poseDistance. */
import { unitScale } from "../units.js";

/**
 * meshes         whose bounding boxes give the centers of models
 * library        { unit, models }
 * unit           of the poses
 * Returns a function from a name to the properties for poseDistance; undefined for models not in
 *   the library.
 */
export async function measuresOf(names, { meshes, library, unit }) {
  const scale = unitScale(library.unit, unit);
  const scaled = (pose) => pose.map(([x, y, z, shift]) => [x, y, z, shift * scale]);
  const measures = new Map();
  const known = library.models.filter(({ name }) => names.includes(name));
  await Promise.all(
    known.map(async ({ name, diameter, symmetry }) => {
      const { min, max } = (await meshes.get(name)).boundingBox;
      measures.set(name, {
        diameter: diameter * scale,
        middle: ["x", "y", "z"].map((axis) => ((min[axis] + max[axis]) / 2) * scale),
        symmetries: (symmetry.declaration?.symmetries ?? []).map((pose) => [
          ...scaled(pose.slice(0, 3)),
          [0, 0, 0, 1],
        ]),
        axis: symmetry.declaration?.symmetry_axis?.axis ?? null,
      });
    }),
  );
  return (name) => measures.get(name);
}

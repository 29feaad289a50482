import { CylinderGeometry, Group, Mesh, MeshBasicMaterial, Quaternion, Vector3 } from "three";

// The length and the thickness of an axis, in radii of the model.
const kReach = 1.25;
const kThickness = 0.006;
// The number of dashes of the axis of a near symmetry.
const kDashes = 14;

/**
 * Symmetry axes of a model, as lines; dashed for near symmetries.
 *
 * axes   [{ direction, point, near }] in the model's frame
 * radius of the model
 * color  of the lines
 */
export function makeTurnAxes(axes, radius, color) {
  const group = new Group();
  const material = new MeshBasicMaterial({ color });
  for (const { direction, point, near } of axes) {
    const along = new Vector3(...direction).normalize();
    const length = 2 * kReach * radius;
    const count = near ? kDashes : 1;
    const step = length / count;
    const bar = new CylinderGeometry(kThickness * radius, kThickness * radius, near ? step / 2 : step, 8);
    for (let k = 0; k < count; ++k) {
      const mesh = new Mesh(bar, material);
      mesh.quaternion.copy(new Quaternion().setFromUnitVectors(new Vector3(0, 1, 0), along));
      mesh.position.set(...point).addScaledVector(along, (k + 0.5) * step - length / 2);
      group.add(mesh);
    }
  }
  return group;
}

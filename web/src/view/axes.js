import { CylinderGeometry, Group, Mesh, MeshBasicMaterial } from "three";

/** The axes of a model's frame: x red, y green, z blue, of length 1; drawn over everything. */
export function makeAxes() {
  const axes = new Group();
  const bar = new CylinderGeometry(0.012, 0.012, 1, 8).translate(0, 0.5, 0);
  const turns = [
    [0, 0, -Math.PI / 2],
    [0, 0, 0],
    [Math.PI / 2, 0, 0],
  ];
  ["#e5484d", "#3fae5a", "#4a7dff"].forEach((color, k) => {
    const mesh = new Mesh(bar, new MeshBasicMaterial({ color, depthTest: false }));
    mesh.rotation.set(...turns[k]);
    mesh.renderOrder = 1;
    axes.add(mesh);
  });
  axes.matrixAutoUpdate = false;
  axes.visible = false;
  return axes;
}

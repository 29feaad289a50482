import { Color, Mesh } from "three";

import { frameOf } from "./frame.js";
import { foundMaterial, kSelectedOutline } from "./materials.js";
import { outlineMaterial } from "./picture.js";
import { makeScanPoints } from "./scan_points.js";

/**
 * Draws a small scan and a found model once, in a few pixels. Shader programs are compiled at their
 * first use, for which the page would otherwise wait while it draws pictures of many points.
 *
 * scenes  { solid, outlined }
 * color   of the scan
 * Returns the drawn objects, which are to be kept, as unused programs are discarded.
 */
export function warmUp(picture, { solid, outlined }, camera, color) {
  const corners = new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]);
  const points = makeScanPoints(corners, frameOf(corners));
  points.material.uniforms.color.value = points.material.uniforms.dim.value = color;
  const mesh = new Mesh(points.geometry, foundMaterial());
  // SeenParts draws outlines among solid objects, whose lights require another shader program.
  const [outline, seen] = [0, 1].map(
    () => new Mesh(points.geometry, outlineMaterial(kSelectedOutline, new Color())),
  );
  const drawn = [points, mesh, outline, seen];
  for (const thing of drawn) thing.frustumCulled = false;
  solid.add(points, mesh, seen);
  outlined.add(outline);
  const hidden = solid.children.filter(({ visible }) => !visible);
  for (const thing of hidden) thing.visible = true;
  picture.render(solid, outlined, camera, 1, 1);
  for (const thing of hidden) thing.visible = false;
  for (const thing of drawn) thing.removeFromParent();
  return drawn;
}

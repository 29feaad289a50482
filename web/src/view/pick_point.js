import { Vector4 } from "three";

// The largest distance of a point from the pointer [pixel].
const kReach = 10;

/**
 * The point of a scan at a position of the canvas: among those near the pointer the one nearest to
 * the camera, else null.
 *
 * positions  x, y, z of each
 * project    Matrix4 from positions to clip space
 * pointer    { x, y: in the canvas, width, height: of the canvas } [pixel]
 * isSeen     whether a position [x, y, z] is drawn
 */
export function pickPoint(positions, project, { x, y, width, height }, isSeen) {
  const clip = new Vector4();
  let best = null;
  for (let i = 0; i < positions.length; i += 3) {
    clip.set(positions[i], positions[i + 1], positions[i + 2], 1).applyMatrix4(project);
    if (clip.w <= 0) continue;
    const dx = ((clip.x / clip.w + 1) * width) / 2 - x;
    const dy = ((1 - clip.y / clip.w) * height) / 2 - y;
    const off = Math.hypot(dx, dy);
    if (off > kReach) continue;
    // A pixel of offset costs as much as a two-hundredth of the distance.
    const cost = clip.w * (1 + off / 200);
    if (best && cost >= best.cost) continue;
    if (isSeen(positions.slice(i, i + 3))) best = { cost, at: i };
  }
  return best && [...positions.slice(best.at, best.at + 3)];
}

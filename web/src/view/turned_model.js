import { DoubleSide, Group, Mesh, MeshBasicMaterial, MeshLambertMaterial, SphereGeometry } from "three";

// The radius of the ball, in radii of the model.
const kBall = 0.035;
const kOpacity = 0.45;

/**
 * A model rotated by a near symmetry over itself, and a ball at the largest deviation.
 *
 * geometry  of the model
 * turned    { matrix: of the rotation, place: of the largest deviation } in the model's frame
 * radius    of the model
 */
export function makeTurned(geometry, { matrix, place }, radius, color) {
  const copy = new Mesh(
    geometry,
    new MeshLambertMaterial({
      color,
      flatShading: true,
      side: DoubleSide,
      transparent: true,
      opacity: kOpacity,
      depthWrite: false,
    }),
  );
  copy.matrixAutoUpdate = false;
  copy.matrix.copy(matrix);
  const ball = new Mesh(
    new SphereGeometry(kBall * radius, 16, 12),
    new MeshBasicMaterial({ color, depthTest: false, transparent: true }),
  );
  // The ball is drawn over everything else, since it may lie inside the model.
  ball.renderOrder = 1;
  ball.position.copy(place);
  return new Group().add(copy, ball);
}

import { Matrix4, Vector3 } from "three";

const kSamples = 20000;
// This share of the points at either end has no influence on the size of the rest.
const kStray = 0.02;
const kMargin = 1.03;

function sampleOf(positions) {
  const step = 3 * Math.max(1, Math.floor(positions.length / 3 / kSamples));
  const sample = [];
  for (let i = 0; i < positions.length; i += step) {
    sample.push(new Vector3().fromArray(positions, i));
  }
  return sample;
}

function quantile(values, share) {
  values.sort((a, b) => a - b);
  return values[Math.round((values.length - 1) * share)];
}

/**
 * Determines how a scan or a model is shown: centered, upright, with a radius of about 1.
 *
 * positions  x, y, z of each point in its frame, at least one
 * viewpoint  of the sensor in that frame; null: no sensor
 *
 * The up direction follows the usual frames: cameras view along +z with y down (OpenCV) or along -z
 * with y up (OpenGL); with any other view direction, the scan stands on a floor with z up (ROS, REP
 * 103), as models do.
 *
 * Returns { center, radius: both in its frame; toWorld; sample: some of the points, in the world;
 *   direction: from the center to the best viewpoint, in the world; sensor: its position in the
 *   world, or null }.
 */
export function frameOf(positions, viewpoint) {
  const sample = sampleOf(positions);
  const middle = (axis) => {
    const values = sample.map((point) => point[axis]);
    return (quantile(values, kStray) + quantile(values, 1 - kStray)) / 2;
  };
  const center = new Vector3(middle("x"), middle("y"), middle("z"));
  const distances = sample.map((point) => point.distanceTo(center));
  const radius = quantile(distances, 1 - kStray) || 1;

  const toSensor = new Vector3(...(viewpoint ?? center)).sub(center);
  // A viewpoint inside the scan is that of no sensor.
  const isSeen = toSensor.length() > radius;
  const along = (axis) => Math.abs(toSensor[axis]);
  const isCamera = isSeen && along("z") >= Math.max(along("x"), along("y"));
  const up = isCamera ? new Vector3(0, Math.sign(toSensor.z), 0) : new Vector3(0, 0, 1);
  const front = isSeen ? toSensor.clone() : new Vector3(1, -1, 0);
  front.addScaledVector(up, -front.dot(up));
  if (front.length() < 1e-6) front.set(1, 0, 0);
  front.normalize();
  const rotation = new Matrix4()
    .makeBasis(new Vector3().crossVectors(up, front), up, front)
    .transpose();
  const toWorld = rotation
    .clone()
    .scale(new Vector3().setScalar(1 / radius))
    .multiply(new Matrix4().makeTranslation(center.clone().negate()));
  for (const point of sample) point.applyMatrix4(toWorld);
  const direction = isSeen
    ? toSensor.transformDirection(rotation)
    : new Vector3(0, 0.55, 1).normalize();
  const sensor = isSeen ? new Vector3(...viewpoint).applyMatrix4(toWorld) : null;
  return { center, radius, toWorld, sample, direction, sensor };
}

/**
 * The distance from the world origin at which a camera sees these points.
 *
 * points      in the world
 * direction   from the origin to the camera
 * across, up  tangents of half the field of view
 * stray       fraction of the points that may be outside
 */
export function distanceToSee(points, direction, { across, up }, stray = 0) {
  const right = new Vector3().crossVectors(new Vector3(0, 1, 0), direction).normalize();
  const above = new Vector3().crossVectors(direction, right);
  const distances = points.map(
    (point) =>
      point.dot(direction) +
      Math.max(Math.abs(point.dot(right)) / across, Math.abs(point.dot(above)) / up),
  );
  return kMargin * quantile(distances, 1 - stray);
}

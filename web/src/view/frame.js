import { Matrix4, Vector3 } from "three";

const kSamples = 20000;
const kShareWithin = 0.97; // stray points must not make the rest small

const at = (positions, i) => new Vector3().fromArray(positions, 3 * i);

/**
 * Say how a scan is shown: centred, upright, with radius 1.
 *
 * positions  x, y, z of each point in the scan's frame, at least one
 * viewpoint  of the sensor in that frame
 *
 * Up is that of the usual frames: cameras look along +z with y down (OpenCV) or along -z with y up
 * (OpenGL); whatever looks elsewhere stands on a floor with z up (ROS, REP 103).
 *
 * Returns { centre, radius (both in the scan's frame), toWorld, direction: from the centre to the
 * sensor, in the world }.
 */
export function frameOf(positions, viewpoint) {
  const step = Math.max(1, Math.floor(positions.length / 3 / kSamples));
  const sample = [];
  for (let i = 0; 3 * i < positions.length; i += step) sample.push(at(positions, i));
  const middle = (axis) => {
    const values = sample.map((point) => point[axis]).sort((a, b) => a - b);
    return (values[Math.floor(values.length * 0.02)] + values[Math.floor(values.length * 0.98)]) / 2;
  };
  const centre = new Vector3(middle("x"), middle("y"), middle("z"));
  const distances = sample.map((point) => point.distanceTo(centre)).sort((a, b) => a - b);
  const radius = distances[Math.floor((distances.length - 1) * kShareWithin)] || 1;
  return uprightFrame(centre, radius, new Vector3(...viewpoint).sub(centre));
}

/** That of a model or any other thing that nobody looked at: z up, seen from above one corner. */
export function frameOfSphere({ center, radius }) {
  return uprightFrame(center.clone(), radius || 1, new Vector3());
}

function uprightFrame(centre, radius, toSensor) {
  const seen = toSensor.length() > radius;
  const along = (axis) => Math.abs(toSensor[axis]);
  const camera = seen && along("z") >= Math.max(along("x"), along("y"));
  const up = camera ? new Vector3(0, toSensor.z < 0 ? -1 : 1, 0) : new Vector3(0, 0, 1);
  const front = (seen ? toSensor : new Vector3(1, -1, 0)).clone();
  front.addScaledVector(up, -front.dot(up));
  if (front.length() < 1e-6) front.set(1, 0, 0);
  front.normalize();
  const right = new Vector3().crossVectors(up, front);
  const rotation = new Matrix4().makeBasis(right, up, front).transpose();
  const toWorld = rotation
    .clone()
    .scale(new Vector3().setScalar(1 / radius))
    .multiply(new Matrix4().makeTranslation(centre.clone().negate()));
  const direction = seen
    ? toSensor.clone().transformDirection(rotation)
    : new Vector3(0, 0.55, 1).normalize();
  return { centre, radius, toWorld, direction };
}

/** Poses in the conventions of robot controllers: the numbers of `trivet recognize --robot-csv`. */

import { unitScale } from "../units.js";

const kDegrees = 180 / Math.PI;
const kUpright = 1 - 1e-12; // sine of a second angle that leaves the other two undetermined

/**
 * The unit quaternion [x, y, z, w], w >= 0, of a rotation.
 *
 * rows  of the matrix, which is only nearly orthonormal if it was stored as floats
 * Source: Shepperd, J. Guidance and Control, 1978, with the branches of Eigen.
 */
export function quaternionOf(rows) {
  const q = [0, 0, 0, 0];
  const trace = rows[0][0] + rows[1][1] + rows[2][2];
  if (trace > 0) {
    const root = Math.sqrt(trace + 1);
    q[3] = root / 2;
    for (let i = 0; i < 3; ++i) {
      const [j, k] = [(i + 1) % 3, (i + 2) % 3];
      q[i] = (rows[k][j] - rows[j][k]) / (2 * root);
    }
  } else {
    const i = [0, 1, 2].reduce((a, b) => (rows[b][b] > rows[a][a] ? b : a));
    const [j, k] = [(i + 1) % 3, (i + 2) % 3];
    const root = Math.sqrt(rows[i][i] - rows[j][j] - rows[k][k] + 1);
    q[i] = root / 2;
    q[3] = (rows[k][j] - rows[j][k]) / (2 * root);
    q[j] = (rows[j][i] + rows[i][j]) / (2 * root);
    q[k] = (rows[k][i] + rows[i][k]) / (2 * root);
  }
  const length = Math.hypot(...q) * (q[3] < 0 ? -1 : 1);
  return q.map((value) => value / length);
}

function rotationOf([x, y, z, w]) {
  return [
    [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
    [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
    [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
  ];
}

/** Angles about the fixed axes x, y, z, in this order; where they are undetermined, x is 0. */
function fixedAngles(q) {
  const r = rotationOf(q);
  const sine = -r[2][0];
  if (Math.abs(sine) > kUpright) {
    return [0, Math.sign(sine) * (Math.PI / 2), Math.atan2(-r[0][1], r[1][1])];
  }
  return [Math.atan2(r[2][1], r[2][2]), Math.asin(sine), Math.atan2(r[1][0], r[0][0])];
}

const fixedDegrees = (q) => fixedAngles(q).map((angle) => kDegrees * angle);

function rotationVector([x, y, z, w]) {
  const sine = Math.hypot(x, y, z);
  if (sine === 0) return [0, 0, 0];
  const perSine = (2 * Math.atan2(sine, w)) / sine;
  return [x, y, z].map((value) => value * perSine);
}

/** label; names and unit of the orientation's numbers; length: unit of the position */
export const kConventions = {
  quaternion: {
    label: "ROS: quaternion",
    names: ["qx", "qy", "qz", "qw"],
    length: "m",
    unit: "",
    orientation: (q) => q,
  },
  rpy: {
    label: "URDF: roll, pitch, yaw",
    names: ["roll", "pitch", "yaw"],
    length: "m",
    unit: "rad",
    orientation: fixedAngles,
  },
  kuka: {
    label: "KUKA: A, B, C",
    names: ["A", "B", "C"],
    length: "mm",
    unit: "deg",
    orientation: (q) => fixedDegrees(q).reverse(),
  },
  fanuc: {
    label: "Fanuc: W, P, R",
    names: ["W", "P", "R"],
    length: "mm",
    unit: "deg",
    orientation: fixedDegrees,
  },
  ur: {
    label: "Universal Robots: rotation vector",
    names: ["rx", "ry", "rz"],
    length: "m",
    unit: "rad",
    orientation: rotationVector,
  },
  abb: {
    label: "ABB: quaternion, scalar first",
    names: ["q1", "q2", "q3", "q4"],
    length: "mm",
    unit: "",
    orientation: ([x, y, z, w]) => [w, x, y, z],
  },
};

/**
 * rows        of T_scene_model, in the unit of the scan
 * convention  quaternion, rpy, kuka, fanuc, ur or abb
 * Returns [{ name, value, unit: "" for a quaternion's }]: x, y, z and the orientation.
 */
export function robotPose(rows, unit, convention) {
  const { names, length, unit: turned, orientation } = kConventions[convention];
  const scale = unitScale(unit, length);
  return [
    ...["x", "y", "z"].map((name, k) => ({ name, value: scale * rows[k][3], unit: length })),
    ...orientation(quaternionOf(rows)).map((value, k) => ({ name: names[k], value, unit: turned })),
  ];
}

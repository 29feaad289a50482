/** Frames given by users: the scan's pose in the robot frame, and grasps. */

const kLoose = 0.01; // of an entry of a rotation, as written by calibrations
const kShortestInMm = 10; // a robot that is nearer to its scans was told meters
const kLongestInM = 50; // one that is farther was told millimeters
const kNearestGrasp = { share: 0.1, mm: 1 }; // of the diameter, and in mm: what is less was told in m
const kFarthestGrasp = { share: 10, m: 1 };

/** The name of the scan frame in tables. */
export const kSceneFrame = "scene";

/** The rows of a frame, one per line; "" for none. */
export const frameText = (rows) => (rows ? rows.map((row) => row.join(" ")).join("\n") : "");

/** The product of two poses given by four rows. */
export const product = (a, b) =>
  a.map((row) => b[0].map((_, k) => row.reduce((sum, x, j) => sum + x * b[j][k], 0)));

/** A pose converted to another unit. */
export const scaled = (rows, scale) =>
  rows.map((row, k) => (k < 3 ? [row[0], row[1], row[2], scale * row[3]] : row));

function checkedFrame(numbers) {
  if (numbers.length !== 16 || !numbers.every(Number.isFinite)) {
    const count = numbers.filter(Number.isFinite).length;
    throw new Error(`expected four rows of four numbers, found ${count} of 16`);
  }
  const rows = [0, 4, 8, 12].map((first) => numbers.slice(first, first + 4));
  const columns = [0, 1, 2].map((k) => rows.slice(0, 3).map((row) => row[k]));
  const dot = (a, b) => a.reduce((sum, x, k) => sum + x * b[k], 0);
  const [x, y, z] = columns;
  const isTurn =
    columns.every((a, i) => columns.every((b, j) => Math.abs(dot(a, b) - (i === j)) <= 2 * kLoose)) &&
    x[0] * (y[1] * z[2] - y[2] * z[1]) -
      y[0] * (x[1] * z[2] - x[2] * z[1]) +
      z[0] * (x[1] * y[2] - x[2] * y[1]) >
      0;
  if (!isTurn) throw new Error("expected a rotation in the upper left 3 x 3 numbers");
  if (rows[3].some((value, k) => Math.abs(value - (k === 3)) > 1e-6)) {
    throw new Error("expected 0 0 0 1 in the last row");
  }
  return rows;
}

// null, strings and booleans of JSON are rejected, though Number() converts some of them.
const numbersIn = (json) =>
  Array.isArray(json) ? json.flat(2).map((value) => (typeof value === "number" ? value : NaN)) : [];

const lengthOf = (rows) => Math.hypot(...rows.slice(0, 3).map((row) => row[3]));

/** The other unit, if a calibration read in this unit probably has that one; otherwise null. */
export function likelierUnit(rows, unit) {
  const length = lengthOf(rows);
  if (unit === "mm" && length > 0 && length < kShortestInMm) return "m";
  return unit === "m" && length > kLongestInM ? "mm" : null;
}

/**
 * The first model whose grasps, read in the library's unit, probably have the other unit: { model,
 * length: of the longest, unit: the other }, or null.
 */
export function likelierGraspUnit(grasps, { library, models }) {
  for (const { name, diameter } of models) {
    const length = Math.max(0, ...Object.values(grasps[name] ?? {}).map(lengthOf));
    const isNear = length > 0 && length < Math.min(kNearestGrasp.mm, kNearestGrasp.share * diameter);
    const isFar = length > Math.max(kFarthestGrasp.m, kFarthestGrasp.share * diameter);
    if (library === "mm" && isNear) return { model: name, length, unit: "m" };
    if (library === "m" && isFar) return { model: name, length, unit: "mm" };
  }
  return null;
}

/** Errors: a name that files and tables cannot contain, or that names the scan frame. */
export function checkedName(name) {
  if (!/^[A-Za-z][\w-]{0,63}$/.test(name) || name.toLowerCase() === kSceneFrame) {
    throw new Error(
      `expected a name of the robot's frame of letters, digits, _ and -, other than ${kSceneFrame}, ` +
        `found “${name}”`,
    );
  }
}

/**
 * The four rows of a frame.
 *
 * text  JSON, or numbers separated by spaces, commas or lines
 * Errors: not a rotation and a position.
 */
export function readFrame(text) {
  let numbers;
  try {
    numbers = numbersIn(JSON.parse(text));
  } catch {
    numbers = text.split(/[\s,;[\]]+/).filter(Boolean).map(Number);
  }
  return checkedFrame(numbers);
}

/**
 * Grasps by model, and by name in the order of the names: the file format of `trivet recognize
 * --grasps`.
 *
 * Errors: not JSON of {"MODEL": {"GRASP": rows}}; an invalid frame, with its name.
 */
export function readGrasps(text) {
  const isObject = (json) => json !== null && typeof json === "object" && !Array.isArray(json);
  let models;
  try {
    models = JSON.parse(text);
  } catch {
    models = null;
  }
  if (!isObject(models) || !Object.values(models).every(isObject)) {
    throw new Error('expected {"MODEL": {"GRASP": four rows of four numbers}} in JSON');
  }
  const grasp = (model, [name, rows]) => {
    try {
      return [name, checkedFrame(numbersIn(rows))];
    } catch (error) {
      throw new Error(`${model}, ${name}: ${error.message}`);
    }
  };
  return Object.fromEntries(
    Object.entries(models).map(([model, grasps]) => [
      model,
      Object.fromEntries(
        Object.entries(grasps)
          .sort(([a], [b]) => (a < b ? -1 : 1))
          .map((entry) => grasp(model, entry)),
      ),
    ]),
  );
}

/** Frames given by users: the scan's pose in the robot frame, and grasps. */

// How far an entry of a rotation may be off, as calibrations write them.
const kLoose = 0.01;
/** The name of the scan frame in tables. */
export const kSceneFrame = "scene";

/** The rows of a frame, one per line; "" for none. */
export const frameText = (rows) => (rows ? rows.map((row) => row.join(" ")).join("\n") : "");

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

/** Matches the detections of two answers by the distance and rule of `trivet compare`. */

// The largest translation between alike poses, as a share of the diameter.
const kMaxTranslation = 0.1;
const kMaxRotationDeg = 12;

const kIdentity = [
  [1, 0, 0, 0],
  [0, 1, 0, 0],
  [0, 0, 1, 0],
  [0, 0, 0, 1],
];

/** The product of two matrices with four rows. */
const product = (a, b) =>
  a.map((row) => [0, 1, 2, 3].map((k) => row.reduce((sum, x, i) => sum + x * b[i][k], 0)));
const moved = (pose, [x, y, z]) =>
  pose.slice(0, 3).map((row) => row[0] * x + row[1] * y + row[2] * z + row[3]);
const turned = (pose, [x, y, z]) =>
  pose.slice(0, 3).map((row) => row[0] * x + row[1] * y + row[2] * z);
const distance = (a, b) => Math.hypot(...a.map((x, axis) => x - b[axis]));

/** The angle between unit vectors [radians]; also exact for small angles. */
const angleBetween = (a, b) =>
  2 * Math.atan2(distance(a, b), Math.hypot(...a.map((x, axis) => x + b[axis])));

/** The angle of the rotation from one pose to the other [radians]. */
function turnBetween(a, b) {
  // The squared difference of both matrices is 8 sin² of half the angle.
  let squares = 0;
  for (let i = 0; i < 3; ++i) for (let j = 0; j < 3; ++j) squares += (a[i][j] - b[i][j]) ** 2;
  return 2 * Math.asin(Math.min(1, Math.sqrt(squares / 8)));
}

/**
 * The distance between two poses of a model: the sum of both errors as fractions of their limits,
 * minimized over the symmetries; null: the poses differ.
 *
 * model  { diameter, middle: of its bounding box, symmetries: poses besides the identity, axis:
 *        direction or null }, in the unit of the poses
 */
export function poseDistance(a, b, model) {
  let best = null;
  for (const symmetry of [kIdentity, ...model.symmetries]) {
    const other = product(b, symmetry);
    const shift = distance(moved(a, model.middle), moved(other, model.middle)) / model.diameter;
    const angle = model.axis
      ? angleBetween(turned(a, model.axis), turned(other, model.axis))
      : turnBetween(a, other);
    const turn = (180 / Math.PI) * angle;
    const rank = shift / kMaxTranslation + turn / kMaxRotationDeg;
    if (best === null || rank < best.rank) best = { rank, shift, turn };
  }
  return best.shift < kMaxTranslation && best.turn < kMaxRotationDeg ? best.rank : null;
}

/**
 * Pairs of detections of one model with similar poses, nearest first, each detection at most once.
 *
 * first, second  [{ model, T_scene_model }]
 * modelOf        returns by name the model for poseDistance, or undefined: then no two poses match
 * Returns [[index in first, index in second]], sorted by the first.
 */
export function matchDetections(first, second, modelOf) {
  const alike = [];
  first.forEach((one, i) => {
    const model = modelOf(one.model);
    second.forEach((other, j) => {
      if (!model || one.model !== other.model) return;
      const rank = poseDistance(one.T_scene_model, other.T_scene_model, model);
      if (rank !== null) alike.push([rank, i, j]);
    });
  });
  alike.sort((a, b) => a[0] - b[0] || a[1] - b[1] || a[2] - b[2]);
  const pairs = [];
  for (const [, i, j] of alike) {
    if (!pairs.some(([one, other]) => one === i || other === j)) pairs.push([i, j]);
  }
  return pairs.sort((a, b) => a[0] - b[0]);
}

/**
 * Compares two runs on the scans that both have answers for.
 *
 * scans  [{ name, a, b: detections, secondsA, secondsB: or null }]
 * Returns { rows: [{ name, both, onlyA, onlyB, secondsA, secondsB }], total: their sums }.
 */
export function compareRuns(scans, modelOf) {
  const rows = scans.map(({ name, a, b, secondsA, secondsB }) => {
    const both = matchDetections(a, b, modelOf).length;
    return { name, both, onlyA: a.length - both, onlyB: b.length - both, secondsA, secondsB };
  });
  const sum = (key) =>
    rows.reduce((all, row) => (all === null || row[key] === null ? null : all + row[key]), 0);
  const keys = ["both", "onlyA", "onlyB", "secondsA", "secondsB"];
  return { rows, total: Object.fromEntries(keys.map((key) => [key, sum(key)])) };
}

/**
 * The probability of a difference this large or larger between two equally good runs: McNemar's
 * exact two-sided test, as in `trivet compare` and `trivet study`.
 *
 * onlyA, onlyB  numbers of detections that only one of the runs has
 */
export function pairedChance(onlyA, onlyB) {
  const n = onlyA + onlyB;
  const fewer = Math.min(onlyA, onlyB);
  // The two-sided binomial probability for n fair coins. The chance of exactly `fewer` on one side
  // is computed in logarithms, as 2^n may be too large; the smaller counts follow as ratios of it.
  let logChance = -n * Math.LN2;
  for (let i = 1; i <= fewer; ++i) logChance += Math.log((n - fewer + i) / i);
  let sum = 0;
  for (let i = fewer, share = 1; share > 0; --i) {
    sum += share;
    share *= i / (n - i + 1);
  }
  return Math.min(1, 2 * Math.exp(logChance) * sum);
}

/**
 * Compares the detections of two runs with the ground truth.
 *
 * scans  [{ a, b: detections, truth: [{ model, T_scene_model }], or null where it is not known }]
 * Returns { scans: number with a truth, right: number of true poses in them, foundA, foundB, onlyA,
 *   onlyB, wrongA, wrongB, chance: see pairedChance }.
 */
export function compareByTruth(scans, modelOf) {
  const known = scans.filter(({ truth }) => truth !== null);
  const sums = { scans: known.length, right: 0, foundA: 0, foundB: 0, onlyA: 0, onlyB: 0 };
  let [detectionsA, detectionsB] = [0, 0];
  for (const { a, b, truth } of known) {
    const [inA, inB] = [a, b].map(
      (detections) => new Set(matchDetections(detections, truth, modelOf).map(([, k]) => k)),
    );
    sums.right += truth.length;
    sums.foundA += inA.size;
    sums.foundB += inB.size;
    sums.onlyA += [...inA].filter((k) => !inB.has(k)).length;
    sums.onlyB += [...inB].filter((k) => !inA.has(k)).length;
    detectionsA += a.length;
    detectionsB += b.length;
  }
  return {
    ...sums,
    wrongA: detectionsA - sums.foundA,
    wrongB: detectionsB - sums.foundB,
    chance: pairedChance(sums.onlyA, sums.onlyB),
  };
}

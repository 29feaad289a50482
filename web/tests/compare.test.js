/** Which detections are the same, held against quaternions and brute force. */
import { test, expect } from "@playwright/test";

import {
  compareByTruth,
  compareRuns,
  matchDetections,
  pairedChance,
  poseDistance,
} from "../src/compare.js";

const kHalfTurn = [
  [-1, 0, 0, 0.2],
  [0, -1, 0, 0],
  [0, 0, 1, 0],
  [0, 0, 0, 1],
];
const kModel = { diameter: 0.2, middle: [0.1, 0, 0], symmetries: [], axis: null };

/** A rotation about an axis by degrees, then a shift. */
function poseOf(axis, degrees, shift) {
  const length = Math.hypot(...axis);
  const [x, y, z] = axis.map((a) => (a / length) * Math.sin((degrees * Math.PI) / 360));
  const w = Math.cos((degrees * Math.PI) / 360);
  return [
    [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), shift[0]],
    [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), shift[1]],
    [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), shift[2]],
    [0, 0, 0, 1],
  ];
}
const detection = (pose, model = "nut") => ({ model, T_scene_model: pose });

test("poses are alike within a tenth of the diameter and 12 degrees of the middle", () => {
  const at = poseOf([1, 2, 3], 40, [0, 0, 1]);
  const central = { ...kModel, middle: [0, 0, 0] };
  for (const degrees of [0.01, 3, 11.9, 12.1, 90, 180]) {
    const rank = poseDistance(at, poseOf([1, 2, 3], 40 + degrees, [0, 0, 1]), central);
    if (degrees < 12) expect(rank).toBeCloseTo(degrees / 12, 6);
    else expect(rank).toBeNull();
  }
  expect(poseDistance(at, poseOf([1, 2, 3], 40, [0, 0.01, 1]), central)).toBeCloseTo(0.5, 9);
  expect(poseDistance(at, poseOf([1, 2, 3], 40, [0, 0.021, 1]), central)).toBeNull();
  // Turned about its origin, the middle of a model beside it moves, too: 0.1 m by 10 degrees.
  const beside = poseDistance(poseOf([0, 0, 1], 0, [0, 0, 0]), poseOf([0, 0, 1], 10, [0, 0, 0]), kModel);
  const shift = (2 * 0.1 * Math.sin((5 * Math.PI) / 180)) / 0.2;
  expect(beside).toBeCloseTo(shift / 0.1 + 10 / 12, 9);
});

test("symmetries and free axes are left out", () => {
  const at = poseOf([1, 2, 3], 40, [0, 0, 1]);
  const around = (degrees) => {
    const turn = poseOf([0, 0, 1], degrees, [0, 0, 0]);
    const turned = at.map((row) => [0, 1, 2, 3].map((k) => row.reduce((s, x, i) => s + x * turn[i][k], 0)));
    return turned;
  };
  const central = { ...kModel, middle: [0, 0, 0] };
  const half = [kHalfTurn.map((row) => [...row.slice(0, 3), row === kHalfTurn[3] ? 1 : 0])];
  expect(poseDistance(at, around(180), central)).toBeNull();
  expect(poseDistance(at, around(180), { ...central, symmetries: half })).toBeCloseTo(0, 6);
  expect(poseDistance(at, around(77), { ...central, axis: [0, 0, 1] })).toBeCloseTo(0, 6);
  // About a line beside the origin, the motion as a whole counts.
  const moved = at.map((row) => [0, 1, 2, 3].map((k) => row.reduce((s, x, i) => s + x * kHalfTurn[i][k], 0)));
  expect(poseDistance(at, moved, { ...kModel, symmetries: [kHalfTurn] })).toBeCloseTo(0, 6);
});

test("each detection is paired once, the nearest first, either way round", () => {
  const central = { ...kModel, middle: [0, 0, 0] };
  const modelOf = (name) => (name === "ghost" ? undefined : central);
  let seed = 7;
  const random = () => (seed = (seed * 48271) % 2147483647) / 2147483647;
  const some = (count) =>
    Array.from({ length: count }, () =>
      detection(
        poseOf([random(), random(), 1], 20 * random(), [0.06 * random(), 0, 1]),
        random() < 0.5 ? "nut" : "bolt",
      ),
    );
  for (let k = 0; k < 20; ++k) {
    const [a, b] = [some(6), some(5)];
    const pairs = matchDetections(a, b, modelOf);
    const swapped = matchDetections(b, a, modelOf).map(([j, i]) => [i, j]);
    expect(swapped.sort((x, y) => x[0] - y[0])).toEqual(pairs);
    // Stable: of no two that are left to each other, both would be nearer than what they got.
    const rankOf = (i, j) =>
      a[i].model === b[j].model ? poseDistance(a[i].T_scene_model, b[j].T_scene_model, central) : null;
    for (let i = 0; i < a.length; ++i) {
      for (let j = 0; j < b.length; ++j) {
        const rank = rankOf(i, j);
        if (rank === null) continue;
        const got = pairs.filter(([x, y]) => x === i || y === j).map(([x, y]) => rankOf(x, y));
        expect(Math.min(...got)).toBeLessThanOrEqual(rank);
      }
    }
  }
  const ghosts = [detection(poseOf([0, 0, 1], 0, [0, 0, 1]), "ghost")];
  expect(matchDetections(ghosts, ghosts, modelOf)).toEqual([]);
});

test("runs are summed, and a time that is not known leaves its sum unknown", () => {
  const nut = detection(poseOf([0, 0, 1], 0, [0, 0, 1]));
  const far = detection(poseOf([0, 0, 1], 0, [1, 0, 1]));
  const { rows, total } = compareRuns(
    [
      { name: "one", a: [nut, far], b: [nut], secondsA: 1, secondsB: 2 },
      { name: "two", a: [], b: [far, nut], secondsA: 0.5, secondsB: null },
    ],
    () => kModel,
  );
  expect(rows.map(({ both, onlyA, onlyB }) => [both, onlyA, onlyB])).toEqual([
    [1, 1, 0],
    [0, 0, 2],
  ]);
  expect(total).toEqual({ both: 1, onlyA: 1, onlyB: 2, secondsA: 1.5, secondsB: null });
});

// By hand: twice the tail of the binomial distribution.
test("a difference is chance by McNemar's exact test", () => {
  expect(pairedChance(0, 0)).toBe(1);
  expect(pairedChance(1, 0)).toBe(1);
  expect(pairedChance(0, 5)).toBeCloseTo(2 / 32, 12);
  expect(pairedChance(9, 1)).toBeCloseTo((2 * 11) / 1024, 12);
  expect(pairedChance(4, 4)).toBe(1);
  expect(pairedChance(2000, 3000)).toBeGreaterThan(0);
  expect(pairedChance(2000, 3000)).toBeLessThan(1e-40);
  for (let n = 1; n <= 12; ++n) {
    for (let k = 0; 2 * k < n; ++k) {
      let ways = 0;
      for (let coins = 0; coins < 2 ** n; ++coins)
        ways += coins.toString(2).replaceAll("0", "").length <= k;
      expect(pairedChance(k, n - k)).toBeCloseTo(Math.min(1, (2 * ways) / 2 ** n), 12);
    }
  }
});

test("runs are held against what is known to be right", () => {
  const at = (x, model) => detection(poseOf([0, 0, 1], 0, [x, 0, 1]), model);
  const scans = [
    // One is found by both, one by A, one by none; B has one that is not there, and a wrong model.
    { truth: [at(0), at(1), at(2)], a: [at(0), at(1)], b: [at(0), at(5), at(1, "bolt")] },
    { truth: [], a: [], b: [at(3)] },
    { truth: null, a: [at(4)], b: [] },
  ];
  const { chance, ...counts } = compareByTruth(scans, () => kModel);
  const expected = { scans: 2, right: 3, foundA: 2, foundB: 1, onlyA: 1, onlyB: 0, wrongA: 0, wrongB: 3 };
  expect(counts).toEqual(expected);
  expect(chance).toBe(1);
});

/** Signed distances to meshes, against trying every triangle and counting what a ray crosses. */
import { findDistances, Surface } from "../src/measure/signed_distance.js";
import { countWithin, figuresOf, histogramOf } from "../src/measure/statistics.js";
import { expect, test } from "./fixtures.js";

const minus = (a, b) => a.map((value, k) => value - b[k]);
const dot = (a, b) => a.reduce((sum, value, k) => sum + value * b[k], 0);
const cross = ([a, b, c], [d, e, f]) => [b * f - c * e, c * d - a * f, a * e - b * d];

function randomly(seed) {
  let state = seed;
  return () => ((state = (state * 48271) % 2147483647) / 2147483647) * 2 - 1;
}

/** Distance to a segment. */
function toSegment(p, a, b) {
  const along = minus(b, a);
  const share = Math.min(1, Math.max(0, dot(minus(p, a), along) / dot(along, along)));
  return Math.hypot(...minus(p, a.map((value, k) => value + share * along[k])));
}

/** Distance to a triangle: to its plane where the foot is inside, else to the nearest side. */
function toTriangle(p, [a, b, c]) {
  const normal = cross(minus(b, a), minus(c, a));
  const sides = [
    [a, b],
    [b, c],
    [c, a],
  ];
  const inside = sides.every(([s, t]) => dot(cross(minus(t, s), minus(p, s)), normal) >= 0);
  if (inside) return Math.abs(dot(minus(p, a), normal)) / Math.hypot(...normal);
  return Math.min(...sides.map(([s, t]) => toSegment(p, s, t)));
}

/** Whether a ray in an odd direction leaves the solid once more than it enters it. */
function isInside(p, triangles) {
  const ray = [0.5377, 0.1834, 0.8226];
  let crossings = 0;
  for (const [a, b, c] of triangles) {
    const [u, v] = [minus(b, a), minus(c, a)];
    const across = cross(ray, v);
    const determinant = dot(u, across);
    const s = dot(minus(p, a), across) / determinant;
    const q = cross(minus(p, a), u);
    const t = dot(ray, q) / determinant;
    crossings += s >= 0 && t >= 0 && s + t <= 1 && dot(v, q) / determinant > 0;
  }
  return crossings % 2 === 1;
}

const trianglesOf = ({ vertices, indices }) =>
  Array.from({ length: indices.length / 3 }, (_, k) =>
    [0, 1, 2].map((j) => vertices.slice(3 * indices[3 * k + j], 3 * indices[3 * k + j] + 3)),
  );

function bruteForce(p, triangles) {
  const nearest = Math.min(...triangles.map((triangle) => toTriangle(p, triangle)));
  return isInside(p, triangles) ? -nearest : nearest;
}

const quads = (faces) => faces.flatMap(([a, b, c, d]) => [a, b, c, a, c, d]);

const kCube = {
  vertices: [-1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1, -1, -1, 1, 1, -1, 1, 1, 1, 1, -1, 1, 1],
  indices: quads([
    [0, 3, 2, 1],
    [4, 5, 6, 7],
    [0, 1, 5, 4],
    [1, 2, 6, 5],
    [2, 3, 7, 6],
    [3, 0, 4, 7],
  ]),
};
const kTetrahedron = {
  vertices: [0, 0, 0, 1, 0, 0, 0.1, 0.9, 0, 0.2, 0.1, 0.05], // a flat one, of acute edges
  indices: [0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3],
};

/** A prism over an L, which is concave. */
function prism() {
  const outline = [
    [0, 0],
    [2, 0],
    [2, 0.5],
    [0.5, 0.5],
    [0.5, 2],
    [0, 2],
  ];
  const vertices = [0, 1].flatMap((z) => outline.flatMap(([x, y]) => [x, y, z]));
  const sides = outline.map((_, k) => [k, (k + 1) % 6, ((k + 1) % 6) + 6, k + 6]);
  const caps = [
    [0, 1, 2, 3],
    [0, 3, 4, 5],
  ];
  const top = caps.map((quad) => quad.map((vertex) => vertex + 6));
  const bottom = caps.map((quad) => [...quad].reverse());
  return { vertices, indices: quads([...sides, ...top, ...bottom]) };
}

/** A sphere with dents. */
function dented(rings, slices) {
  const vertices = [];
  for (let i = 0; i <= rings; ++i) {
    for (let j = 0; j < slices; ++j) {
      const [lat, lon] = [(Math.PI * i) / rings, (2 * Math.PI * j) / slices];
      const r = 1 + 0.3 * Math.sin(3 * lat) * Math.cos(4 * lon) * Math.sin(lat);
      const pole = i === 0 || i === rings; // a row of one place, which is one vertex once welded
      vertices.push(
        ...(pole
          ? [0, 0, i ? -1 : 1]
          : [
              r * Math.sin(lat) * Math.cos(lon),
              r * Math.sin(lat) * Math.sin(lon),
              r * Math.cos(lat),
            ]),
      );
    }
  }
  const indices = [];
  for (let i = 0; i < rings; ++i) {
    for (let j = 0; j < slices; ++j) {
      const [a, b] = [i * slices + j, i * slices + ((j + 1) % slices)];
      indices.push(a, a + slices, b + slices, a, b + slices, b);
    }
  }
  return { vertices, indices };
}

const kMeshes = { cube: kCube, tetrahedron: kTetrahedron, prism: prism(), blob: dented(6, 8) };

for (const [name, mesh] of Object.entries(kMeshes)) {
  test(`distances to a ${name} are those of trying every triangle`, () => {
    const surface = new Surface(mesh.vertices, mesh.indices);
    expect(surface.isClosed).toBe(true);
    const triangles = trianglesOf(mesh).filter(
      ([a, b, c]) => Math.hypot(...cross(minus(b, a), minus(c, a))) > 0,
    );
    const random = randomly(7);
    let worst = 0;
    const check = (p, band) => {
      const wanted = bruteForce(p, triangles);
      const found = surface.distance(...p, band);
      const error = Math.abs(wanted) > band ? Number(found === found) : Math.abs(found - wanted);
      worst = error <= worst ? worst : error; // NaN is the worst
    };
    for (let k = 0; k < 500; ++k) {
      check([2 * random(), 2 * random(), 2 * random()], k % 2 ? 10 : Math.abs(random()));
    }
    // Nearest to each corner and to the middle of an edge, on either side.
    for (const [a, b] of triangles) {
      for (const base of [a, a.map((value, k) => (value + b[k]) / 2)]) {
        for (let k = 0; k < 8; ++k) check(base.map((value) => value + 0.01 * random()), 10);
      }
    }
    expect(worst).toBeLessThan(1e-12);
  });
}

test("a mesh that is wound inwards, or shares no vertices, measures the same", () => {
  const inwards = [...kCube.indices].reverse();
  const soup = kCube.indices.flatMap((k) => kCube.vertices.slice(3 * k, 3 * k + 3));
  for (const surface of [new Surface(kCube.vertices, inwards), new Surface(soup, null)]) {
    expect(surface.isClosed).toBe(true);
    expect(surface.distance(2, 2, 2, 9)).toBeCloseTo(Math.sqrt(3), 12);
    expect(surface.distance(0.75, 0, 0, 9)).toBeCloseTo(-0.25, 12);
  }
});

test("an open mesh is positive where its faces look", () => {
  const floor = new Surface([0, 0, 0, 1, 0, 0, 0, 1, 0], [0, 1, 2]);
  expect(floor.isClosed).toBe(false);
  expect(floor.distance(0.2, 0.2, 0.5, 9)).toBe(0.5);
  expect(floor.distance(0.2, 0.2, -0.5, 9)).toBe(-0.5);
});

test("posed and scaled, distances move along, to the nearest of several", () => {
  const surface = new Surface(kMeshes.blob.vertices, kMeshes.blob.indices);
  const [c, s] = [Math.cos(0.7), Math.sin(0.7)];
  const scale = 1000;
  const rows = [
    [c, -s, 0, 5],
    [s * 0.6, c * 0.6, -0.8, -3],
    [s * 0.8, c * 0.8, 0.6, 250],
  ];
  const poseOf = (shift) => [
    ...[0, 1, 2].flatMap((j) => [...rows.map((row) => scale * row[j]), 0]),
    ...rows.map((row) => row[3] + shift),
    1,
  ];
  const random = randomly(3);
  const within = () => 1.5 * random();
  const points = Array.from({ length: 500 }, () => [within(), within(), within()]);
  const moved = points.flatMap((p) => rows.map((row) => scale * dot(row.slice(0, 3), p) + row[3]));
  const out = new Float64Array(points.length);
  const band = 300;
  const targets = [0, 900].map((shift) => ({ surface, pose: poseOf(shift) }));
  findDistances(moved, targets, band, out);
  let [num, worst] = [0, 0];
  points.forEach((p, k) => {
    // Where the second one is, as the first one would see this point.
    const back = [0, 1, 2].map((j) => dot(rows.map((row) => row[j]), [0.9, 0.9, 0.9]));
    const wanted = [p, minus(p, back)]
      .map((at) => scale * surface.distance(...at, 10))
      .reduce((a, b) => (Math.abs(b) < Math.abs(a) ? b : a));
    const isFar = Math.abs(wanted) > band;
    num += !isFar;
    worst = Math.max(worst, isFar ? Number(out[k] === out[k]) : Math.abs(out[k] - wanted));
  });
  expect(num).toBeGreaterThan(100);
  expect(worst).toBeLessThan(1e-8);
});

test("figures are those of their definitions", () => {
  const random = randomly(5);
  const values = Float64Array.from({ length: 997 }, (_, k) => (k % 7 ? 2 * random() + 0.3 : NaN));
  const told = [...values].filter((value) => value === value);
  const sorted = told.map(Math.abs).sort((a, b) => a - b);
  const { num, mean, rms, p95 } = figuresOf(values);
  expect(num).toBe(told.length);
  expect(mean).toBeCloseTo(told.reduce((a, b) => a + b) / num, 12);
  expect(rms).toBeCloseTo(Math.hypot(...told) / Math.sqrt(num), 12);
  const share = sorted.filter((value) => value <= p95).length / num;
  expect(Math.abs(share - 0.95)).toBeLessThan(1 / num);
  expect(countWithin(values, 0.5)).toBe(told.filter((value) => Math.abs(value) <= 0.5).length);
  const counts = histogramOf(values, 1, 8);
  counts.forEach((count, k) => {
    const [low, high] = [-1 + k / 4, -0.75 + k / 4];
    expect(count).toBe(told.filter((value) => value >= low && value < high).length);
  });
});

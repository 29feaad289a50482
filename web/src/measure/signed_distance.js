/** Signed distances of points to triangle meshes. */

// A box with this many triangles is not split further.
const kLeaf = 4;

const kCorners = [0, 1, 2];

/** The feature of a triangle that is nearest to a point: its inside, 1 + corner, 4 + edge. */
const kInside = 0;
const kFirstCorner = 1;
// Edge k is between corner k and the next.
const kFirstEdge = 4;

/** Merges vertices at equal positions: [for each vertex, the first at its position]. */
function weld(vertices) {
  const first = new Map();
  return Uint32Array.from({ length: vertices.length / 3 }, (_, vertex) => {
    const key = vertices.slice(3 * vertex, 3 * vertex + 3).join();
    if (!first.has(key)) first.set(key, vertex);
    return first.get(key);
  });
}

/**
 * A triangle mesh in a tree of bounding boxes. Each face, edge and vertex has a normal that gives
 * the correct sign for all points nearest to it. Source: Baerentzen and Aanaes, IEEE Trans.
 * Visualization and Computer Graphics 2005.
 */
export class Surface {
  // The x, y, z of each vertex.
  #vertices;
  // The three vertices of each triangle, in the order of the tree.
  #corners;
  #faceNormals;
  // The three normals of the edges of each triangle.
  #edgeNormals;
  #vertexNormals;
  // The low and high x, y, z of node k, whose halves are 2 k + 1 and 2 k + 2.
  #boxes;
  #best = { squared: 0, triangle: -1, feature: kInside, x: 0, y: 0, z: 0 };
  // The place whose distance is sought.
  #place = { x: 0, y: 0, z: 0 };
  #nearest = { feature: kInside, x: 0, y: 0, z: 0 };

  /** Whether the mesh bounds a solid: every edge is in two triangles, in opposite directions. */
  isClosed;

  /**
   * vertices  x, y, z of each
   * indices   three vertices of each triangle, counterclockwise as seen from outside; null: every
   *           three vertices are a triangle. A closed mesh may have the opposite winding as a
   *           whole.
   */
  constructor(vertices, indices) {
    this.#vertices = Float64Array.from(vertices);
    const same = weld(vertices);
    const all = indices ? Uint32Array.from(indices, (vertex) => same[vertex]) : same;
    const triangles = Uint32Array.from({ length: all.length / 3 }, (_, k) => k).filter(
      (triangle) => this.#crossProduct(all, triangle).length > 0,
    );
    this.#sort(all, triangles);
    this.#corners = new Uint32Array(3 * triangles.length);
    triangles.forEach((triangle, k) =>
      this.#corners.set(all.subarray(3 * triangle, 3 * triangle + 3), 3 * k),
    );
    this.#boxes = new Float64Array(6 * nodesFor(triangles.length));
    if (triangles.length) this.#bound(0, 0, triangles.length);
    this.#findNormals();
  }

  get numTriangles() {
    return this.#corners.length / 3;
  }

  /** Normal of a triangle from its winding: { x, y, z: unit vector, length: twice the area }. */
  #crossProduct(corners, triangle) {
    const v = this.#vertices;
    const a = 3 * corners[3 * triangle];
    const b = 3 * corners[3 * triangle + 1];
    const c = 3 * corners[3 * triangle + 2];
    const across = (i, j) =>
      (v[b + i] - v[a + i]) * (v[c + j] - v[a + j]) - (v[b + j] - v[a + j]) * (v[c + i] - v[a + i]);
    const x = across(1, 2);
    const y = across(2, 0);
    const z = across(0, 1);
    const length = Math.hypot(x, y, z);
    return { x: x / length, y: y / length, z: z / length, length };
  }

  /** Sorts triangles such that each half of each node is one side of its longest axis. */
  #sort(corners, triangles) {
    const centers = new Float64Array(corners.length);
    for (let i = 0; i < corners.length; ++i) {
      const triangle = i - (i % 3);
      for (let axis = 0; axis < 3; ++axis) {
        centers[triangle + axis] += this.#vertices[3 * corners[i] + axis];
      }
    }
    const split = (first, end) => {
      if (end - first <= kLeaf) return;
      const middle = halfOf(first, end);
      selectMedian(triangles, centers, longestAxis(triangles, centers, first, end), first, end);
      split(first, middle);
      split(middle, end);
    };
    split(0, triangles.length);
  }

  #bound(node, first, end) {
    const boxes = this.#boxes;
    const at = 6 * node;
    if (end - first > kLeaf) {
      const middle = halfOf(first, end);
      this.#bound(2 * node + 1, first, middle);
      this.#bound(2 * node + 2, middle, end);
      const [left, right] = [6 * (2 * node + 1), 6 * (2 * node + 2)];
      for (let axis = 0; axis < 3; ++axis) {
        boxes[at + axis] = Math.min(boxes[left + axis], boxes[right + axis]);
        boxes[at + 3 + axis] = Math.max(boxes[left + 3 + axis], boxes[right + 3 + axis]);
      }
      return;
    }
    boxes.fill(Infinity, at, at + 3);
    boxes.fill(-Infinity, at + 3, at + 6);
    for (let i = 3 * first; i < 3 * end; ++i) {
      for (let axis = 0; axis < 3; ++axis) {
        const value = this.#vertices[3 * this.#corners[i] + axis];
        boxes[at + axis] = Math.min(boxes[at + axis], value);
        boxes[at + 3 + axis] = Math.max(boxes[at + 3 + axis], value);
      }
    }
  }

  /**
   * Normals of faces; at edges the sum of both; at vertices the sum weighted by the angle there.
   */
  #findNormals() {
    const [v, corners, num] = [this.#vertices, this.#corners, this.numTriangles];
    const faces = new Float64Array(3 * num);
    const vertices = new Float64Array(v.length);
    // By their ends: { x, y, z: summed normals, count, direction: summed over the triangles }.
    const edges = new Map();
    const edgeOf = (from, to) => {
      const key = Math.min(from, to) * (v.length / 3) + Math.max(from, to);
      if (!edges.has(key)) edges.set(key, { x: 0, y: 0, z: 0, count: 0, direction: 0 });
      return edges.get(key);
    };
    let volume = 0;
    for (let triangle = 0; triangle < num; ++triangle) {
      const normal = this.#crossProduct(corners, triangle);
      faces.set([normal.x, normal.y, normal.z], 3 * triangle);
      const at = 3 * corners[3 * triangle];
      volume += normal.length * (normal.x * v[at] + normal.y * v[at + 1] + normal.z * v[at + 2]);
      for (const k of kCorners) {
        const [here, next, last] = [k, k + 1, k + 2].map((j) => corners[3 * triangle + (j % 3)]);
        const edge = edgeOf(here, next);
        edge.count += 1;
        edge.direction += here < next ? 1 : -1;
        const angle = angleAt(v, 3 * here, 3 * next, 3 * last);
        for (const [axis, name] of ["x", "y", "z"].entries()) {
          edge[name] += normal[name];
          vertices[3 * here + axis] += angle * normal[name];
        }
      }
    }
    const closes = ({ count, direction }) => count === 2 && direction === 0;
    this.isClosed = num > 0 && [...edges.values()].every(closes);
    const side = this.isClosed && volume < 0 ? -1 : 1;
    this.#faceNormals = faces.map((value) => side * value);
    this.#vertexNormals = vertices.map((value) => side * value);
    this.#edgeNormals = new Float64Array(9 * num);
    for (let i = 0; i < corners.length; ++i) {
      const next = i - (i % 3) + ((i + 1) % 3);
      const { x, y, z } = edgeOf(corners[i], corners[next]);
      this.#edgeNormals.set([side * x, side * y, side * z], 3 * i);
    }
  }

  /**
   * Signed distance of a point, positive outside. An open mesh has no outside: there the distance
   * is positive on the front side of the nearest face.
   *
   * most  larger distances give NaN
   */
  distance(x, y, z, most) {
    const best = this.#best;
    best.squared = most * most;
    best.triangle = -1;
    this.#place.x = x;
    this.#place.y = y;
    this.#place.z = z;
    if (this.numTriangles && this.#squaredToBox(0, x, y, z) <= best.squared) {
      this.#search(0, 0, this.numTriangles, x, y, z);
    }
    if (best.triangle < 0) return NaN;
    const [normals, at] = this.#normalOf(best.triangle, best.feature);
    const side =
      (x - best.x) * normals[at] + (y - best.y) * normals[at + 1] + (z - best.z) * normals[at + 2];
    return Math.sqrt(best.squared) * (side < 0 ? -1 : 1);
  }

  #normalOf(triangle, feature) {
    if (feature === kInside) return [this.#faceNormals, 3 * triangle];
    if (feature >= kFirstEdge) {
      return [this.#edgeNormals, 9 * triangle + 3 * (feature - kFirstEdge)];
    }
    return [this.#vertexNormals, 3 * this.#corners[3 * triangle + feature - kFirstCorner]];
  }

  #search(node, first, end, x, y, z) {
    if (end - first <= kLeaf) {
      for (let triangle = first; triangle < end; ++triangle) this.#try(triangle, x, y, z);
      return;
    }
    const middle = halfOf(first, end);
    const left = 2 * node + 1;
    const right = left + 1;
    const toLeft = this.#squaredToBox(left, x, y, z);
    const toRight = this.#squaredToBox(right, x, y, z);
    if (toLeft <= toRight) {
      if (toLeft <= this.#best.squared) this.#search(left, first, middle, x, y, z);
      if (toRight <= this.#best.squared) this.#search(right, middle, end, x, y, z);
    } else {
      if (toRight <= this.#best.squared) this.#search(right, middle, end, x, y, z);
      if (toLeft <= this.#best.squared) this.#search(left, first, middle, x, y, z);
    }
  }

  #squaredToBox(node, x, y, z) {
    const boxes = this.#boxes;
    const at = 6 * node;
    const dx = Math.max(boxes[at] - x, 0, x - boxes[at + 3]);
    const dy = Math.max(boxes[at + 1] - y, 0, y - boxes[at + 4]);
    const dz = Math.max(boxes[at + 2] - z, 0, z - boxes[at + 5]);
    return dx * dx + dy * dy + dz * dz;
  }

  #try(triangle, x, y, z) {
    const nearest = this.#nearest;
    const best = this.#best;
    findNearest(this.#vertices, this.#corners, 3 * triangle, this.#place, nearest);
    const squared = (x - nearest.x) ** 2 + (y - nearest.y) ** 2 + (z - nearest.z) ** 2;
    if (squared > best.squared || (squared === best.squared && best.triangle >= 0)) return;
    best.squared = squared;
    best.triangle = triangle;
    best.feature = nearest.feature;
    best.x = nearest.x;
    best.y = nearest.y;
    best.z = nearest.z;
  }
}

const halfOf = (first, end) => first + ((end - first) >> 1);

/** The number of nodes of a tree that halves this many triangles. */
function nodesFor(count) {
  let levels = 0;
  for (let most = count; most > kLeaf; most -= most >> 1) ++levels;
  return 2 ** (levels + 1) - 1;
}

function longestAxis(triangles, centers, first, end) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = first; i < end; ++i) {
    for (let axis = 0; axis < 3; ++axis) {
      const value = centers[3 * triangles[i] + axis];
      if (value < low[axis]) low[axis] = value;
      if (value > high[axis]) high[axis] = value;
    }
  }
  const lengths = kCorners.map((axis) => high[axis] - low[axis]);
  return lengths.indexOf(Math.max(...lengths));
}

/** Source: Hoare, Algorithm 65: Find, Comm. ACM 1961. */
function selectMedian(triangles, centers, axis, first, end) {
  const middle = halfOf(first, end);
  let [low, high] = [first, end - 1];
  while (low < high) {
    const pivot = centers[3 * triangles[halfOf(low, high + 1)] + axis];
    let [i, j] = [low, high];
    while (i <= j) {
      while (centers[3 * triangles[i] + axis] < pivot) ++i;
      while (centers[3 * triangles[j] + axis] > pivot) --j;
      if (i > j) break;
      [triangles[i], triangles[j]] = [triangles[j], triangles[i]];
      ++i;
      --j;
    }
    if (middle <= j) high = j;
    else if (middle >= i) low = i;
    else return;
  }
}

/** Angle at a of the triangle a, b, c, which are indices into v. */
function angleAt(v, a, b, c) {
  const dot = (from, to) =>
    kCorners.reduce((sum, k) => sum + (v[from + k] - v[a + k]) * (v[to + k] - v[a + k]), 0);
  const cosine = dot(b, c) / Math.sqrt(dot(b, b) * dot(c, c));
  return Math.acos(Math.min(1, Math.max(-1, cosine)));
}

/**
 * The point of a triangle that is nearest to a place.
 *
 * v      x, y, z of each vertex
 * at     where the vertices of the triangle are in `corners`
 * place  { x, y, z }; out  { x, y, z, feature }
 * Source: Ericson, Real-Time Collision Detection, 2005, 5.1.5.
 */
function findNearest(v, corners, at, { x, y, z }, out) {
  const a = 3 * corners[at];
  const b = 3 * corners[at + 1];
  const c = 3 * corners[at + 2];
  const ax = v[a];
  const ay = v[a + 1];
  const az = v[a + 2];
  const bx = v[b] - ax;
  const by = v[b + 1] - ay;
  const bz = v[b + 2] - az;
  const cx = v[c] - ax;
  const cy = v[c + 1] - ay;
  const cz = v[c + 2] - az;
  const d1 = bx * (x - ax) + by * (y - ay) + bz * (z - az);
  const d2 = cx * (x - ax) + cy * (y - ay) + cz * (z - az);
  const bc = bx * cx + by * cy + bz * cz;
  const d3 = d1 - (bx * bx + by * by + bz * bz);
  const d4 = d2 - bc;
  const d5 = d1 - bc;
  const d6 = d2 - (cx * cx + cy * cy + cz * cz);
  const va = d3 * d6 - d5 * d4;
  const vb = d5 * d2 - d1 * d6;
  const vc = d1 * d4 - d3 * d2;
  let feature = kInside;
  // The shares along a to b and along a to c.
  let s = vb / (va + vb + vc);
  let t = vc / (va + vb + vc);
  if (d1 <= 0 && d2 <= 0) {
    feature = kFirstCorner;
    s = 0;
    t = 0;
  } else if (d3 >= 0 && d4 <= d3) {
    feature = kFirstCorner + 1;
    s = 1;
    t = 0;
  } else if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    feature = kFirstEdge;
    s = d1 / (d1 - d3);
    t = 0;
  } else if (d6 >= 0 && d5 <= d6) {
    feature = kFirstCorner + 2;
    s = 0;
    t = 1;
  } else if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    feature = kFirstEdge + 2;
    s = 0;
    t = d2 / (d2 - d6);
  } else if (va <= 0 && d4 >= d3 && d5 >= d6) {
    feature = kFirstEdge + 1;
    t = (d4 - d3) / (d4 - d3 + (d5 - d6));
    s = 1 - t;
  }
  out.feature = feature;
  out.x = ax + s * bx + t * cx;
  out.y = ay + s * by + t * cy;
  out.z = az + s * bz + t * cz;
}

/**
 * Signed distances of points to the nearest of several posed surfaces.
 *
 * positions  x, y, z of each point
 * targets    [{ surface, pose: the 16 numbers, column by column, of a similarity from the surface's
 *            points to these }]
 * band       larger distances give NaN
 * out        receives a distance for each point from `first` up to `end`
 */
export function findDistances(positions, targets, band, out, first = 0, end = out.length) {
  const scaled = targets.map((target) => {
    const [x, y, z] = target.pose;
    const squared = x * x + y * y + z * z;
    return { ...target, squared, scale: Math.sqrt(squared) };
  });
  for (let i = first; i < end; ++i) {
    let best = NaN;
    let most = band;
    for (const { surface, pose, squared, scale } of scaled) {
      const x = positions[3 * i] - pose[12];
      const y = positions[3 * i + 1] - pose[13];
      const z = positions[3 * i + 2] - pose[14];
      const found = surface.distance(
        (pose[0] * x + pose[1] * y + pose[2] * z) / squared,
        (pose[4] * x + pose[5] * y + pose[6] * z) / squared,
        (pose[8] * x + pose[9] * y + pose[10] * z) / squared,
        most / scale,
      );
      if (Number.isNaN(found)) continue;
      best = found * scale;
      most = Math.abs(best);
    }
    out[i] = best;
  }
}

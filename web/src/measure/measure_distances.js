/**
 * Measures distances of points to posed meshes in a worker.
 *
 * positions   x, y, z of each point
 * things      [{ geometry, pose: Matrix4 from the geometry's points to these }]
 * band        points farther from all meshes have no distance
 * onProgress  called with the completed fraction
 * Returns { distances: of each point to the nearest mesh, positive outside, NaN beyond the band;
 *   isClosed: whether all meshes are; figures: figuresOf(distances) }; null if it is aborted.
 */
export function measureDistances({ positions, things, band }, signal, onProgress) {
  const geometries = [...new Set(things.map(({ geometry }) => geometry))];
  const meshes = geometries.map((geometry) => ({
    vertices: geometry.getAttribute("position").array,
    indices: geometry.getIndex()?.array ?? null,
  }));
  const targets = things.map(({ geometry, pose }) => ({
    mesh: geometries.indexOf(geometry),
    pose: pose.elements,
  }));
  const worker = new Worker(new URL("./distance_worker.js", import.meta.url), { type: "module" });
  return new Promise((resolve, reject) => {
    signal.addEventListener("abort", () => resolve(null));
    worker.onerror = () => reject(new Error("The distances cannot be measured in this browser."));
    worker.onmessage = ({ data }) => (data.distances ? resolve(data) : onProgress(data.done));
    worker.postMessage({ positions, meshes, targets, band });
  }).finally(() => worker.terminate());
}

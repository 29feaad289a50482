/** Measures distances in a worker: responds to one job with progress, then with the distances. */
import { findDistances, Surface } from "./signed_distance.js";
import { figuresOf } from "./statistics.js";

// The number of points between two reports of progress.
const kChunk = 20000;

self.onmessage = ({ data: { positions, meshes, targets, band } }) => {
  const surfaces = meshes.map(({ vertices, indices }) => new Surface(vertices, indices));
  const posed = targets.map(({ mesh, pose }) => ({ surface: surfaces[mesh], pose }));
  const distances = new Float32Array(positions.length / 3);
  for (let first = 0; first < distances.length; first += kChunk) {
    const end = Math.min(first + kChunk, distances.length);
    findDistances(positions, posed, band, distances, first, end);
    self.postMessage({ done: end / distances.length });
  }
  const isClosed = surfaces.every((surface) => surface.isClosed);
  self.postMessage({ distances, isClosed, figures: figuresOf(distances) }, [distances.buffer]);
};

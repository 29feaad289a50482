import { BufferAttribute, BufferGeometry, Matrix4, Points, ShaderMaterial } from "three";

const kProbes = 100;
const kNeighbors = 6; // of a point among random ones, or in a grid, within 1.4 spacings
const kSizeInSpacings = "2.0"; // neighbors overlap, so that a surface looks closed
const kBehind = 0.006; // of the scan's radius: models stand out from the points that they explain

/** How far apart points are where they are rather sparse. */
function spacing(positions) {
  const num = positions.length / 3;
  const distances = [];
  for (let probe = 0; probe < Math.min(kProbes, num); ++probe) {
    const i = 3 * Math.floor(((probe + 0.5) * num) / Math.min(kProbes, num));
    const nearest = new Array(kNeighbors + 1).fill(Infinity); // rising; the first is itself
    for (let k = 0; k < positions.length; k += 3) {
      const x = positions[k] - positions[i];
      const y = positions[k + 1] - positions[i + 1];
      const z = positions[k + 2] - positions[i + 2];
      const squared = x * x + y * y + z * z;
      if (squared >= nearest[kNeighbors]) continue;
      let at = kNeighbors;
      for (; at > 0 && nearest[at - 1] > squared; --at) nearest[at] = nearest[at - 1];
      nearest[at] = squared;
    }
    if (nearest[kNeighbors] < Infinity) distances.push(Math.sqrt(nearest[kNeighbors]) / 1.4);
  }
  distances.sort((a, b) => a - b);
  return distances[Math.floor(distances.length * 0.8)] ?? 0;
}

/**
 * A scan as round points about as large as they are apart.
 *
 * positions  x, y, z of each in the scan's frame
 * frame      frameOf(positions)
 */
export function makeScanPoints(positions, frame) {
  // About the center: a float has too few digits for details far from the origin.
  const { x, y, z } = frame.center;
  const centered = new Float32Array(positions.length);
  for (let i = 0; i < positions.length; i += 3) {
    centered[i] = positions[i] - x;
    centered[i + 1] = positions[i + 1] - y;
    centered[i + 2] = positions[i + 2] - z;
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(centered, 3));
  const material = new ShaderMaterial({
    uniforms: {
      color: { value: null },
      spacing: { value: spacing(centered) / frame.radius },
      behind: { value: kBehind },
      pixelsPerUnit: { value: 1 },
      smallest: { value: 1 },
    },
    vertexShader: `
      uniform float spacing, pixelsPerUnit, smallest;
      varying float seenZ, size;
      void main() {
        vec4 seen = modelViewMatrix * vec4(position, 1.0);
        seenZ = seen.z;
        gl_Position = projectionMatrix * seen;
        size = clamp(${kSizeInSpacings} * spacing * pixelsPerUnit / -seen.z, smallest, 14.0 * smallest);
        gl_PointSize = size;
      }`,
    fragmentShader: `
      uniform vec3 color;
      uniform float spacing, behind;
      uniform mat4 projectionMatrix;
      varying float seenZ, size;
      void main() {
        // A dome instead of a disc: where neighbors meet, depth is continuous. Of few pixels all
        // are needed to close the surface.
        float off = 2.0 * length(gl_PointCoord - 0.5);
        if (off > 1.0 && size > 4.0) discard;
        float z = seenZ - spacing * off * off - behind;
        gl_FragDepth = 0.5 - 0.5 * (projectionMatrix[2][2] + projectionMatrix[3][2] / z);
        gl_FragColor = vec4(color, 0.0); // to be lit by the picture
      }`,
  });
  const points = new Points(geometry, material);
  points.frustumCulled = false;
  points.matrixAutoUpdate = false;
  points.matrix.copy(frame.toWorld).multiply(new Matrix4().makeTranslation(frame.center));
  return points;
}

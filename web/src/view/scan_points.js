import { BufferAttribute, BufferGeometry, Matrix4, Points, ShaderMaterial } from "three";

const kProbes = 100;
const kSizeInSpacings = 1.7; // neighbours overlap, so that a surface looks closed
const kBehind = 0.006; // of the scan's radius: models stand out from the points that they explain

/** The median distance from a point to its nearest neighbour. */
function spacing(positions) {
  const num = positions.length / 3;
  const distances = [];
  for (let probe = 0; probe < Math.min(kProbes, num); ++probe) {
    const i = 3 * Math.floor(((probe + 0.5) * num) / Math.min(kProbes, num));
    let best = Infinity;
    for (let k = 0; k < positions.length; k += 3) {
      if (k === i) continue;
      const x = positions[k] - positions[i];
      const y = positions[k + 1] - positions[i + 1];
      const z = positions[k + 2] - positions[i + 2];
      const squared = x * x + y * y + z * z;
      if (squared < best && squared > 0) best = squared;
    }
    if (best < Infinity) distances.push(Math.sqrt(best));
  }
  distances.sort((a, b) => a - b);
  return distances[Math.floor(distances.length / 2)] ?? 0;
}

/**
 * A scan as round points about as large as they are apart.
 *
 * positions  x, y, z of each in the scan's frame
 * frame      frameOf(positions)
 */
export function makeScanPoints(positions, frame) {
  // About the centre: a float has too few digits for details far from the origin.
  const { x, y, z } = frame.centre;
  const centred = new Float32Array(positions.length);
  for (let i = 0; i < positions.length; i += 3) {
    centred[i] = positions[i] - x;
    centred[i + 1] = positions[i + 1] - y;
    centred[i + 2] = positions[i + 2] - z;
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(centred, 3));
  const material = new ShaderMaterial({
    uniforms: {
      colour: { value: null },
      diameter: { value: (kSizeInSpacings * spacing(centred)) / frame.radius },
      behind: { value: kBehind },
      pixelsPerUnit: { value: 1 },
      smallest: { value: 1 },
    },
    vertexShader: `
      uniform float diameter, pixelsPerUnit, smallest;
      varying float seenZ;
      void main() {
        vec4 seen = modelViewMatrix * vec4(position, 1.0);
        seenZ = seen.z;
        gl_Position = projectionMatrix * seen;
        gl_PointSize = clamp(diameter * pixelsPerUnit / -seen.z, smallest, 24.0 * smallest);
      }`,
    fragmentShader: `
      uniform vec3 colour;
      uniform float diameter, behind;
      uniform mat4 projectionMatrix;
      varying float seenZ;
      void main() {
        // A dome instead of a disc: where neighbours meet, depth is continuous.
        float off = 2.0 * length(gl_PointCoord - 0.5);
        if (off > 1.0) discard;
        float z = seenZ - 0.5 * diameter * off * off - behind;
        gl_FragDepth = 0.5 - 0.5 * (projectionMatrix[2][2] + projectionMatrix[3][2] / z);
        gl_FragColor = vec4(colour, 1.0);
      }`,
  });
  const points = new Points(geometry, material);
  points.frustumCulled = false;
  points.matrixAutoUpdate = false;
  points.matrix
    .copy(frame.toWorld)
    .multiply(new Matrix4().makeTranslation(frame.centre));
  return points;
}

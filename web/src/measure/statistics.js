/** Statistics of signed distances; NaN is ignored. */

/** The quantile of sorted values at this fraction, interpolated between two of them. */
export function quantile(sorted, share) {
  const at = share * (sorted.length - 1);
  const [below, above] = [sorted[Math.floor(at)], sorted[Math.ceil(at)]];
  return below + (at - Math.floor(at)) * (above - below);
}

/** { num, mean, rms: root of the mean square, p95: 95th percentile of the magnitudes } */
export function figuresOf(distances) {
  const magnitudes = distances.filter((value) => !Number.isNaN(value)).map(Math.abs).sort();
  let [sum, squares] = [0, 0];
  for (const value of distances) {
    if (Number.isNaN(value)) continue;
    sum += value;
    squares += value * value;
  }
  const num = magnitudes.length;
  return {
    num,
    mean: sum / num,
    rms: Math.sqrt(squares / num),
    p95: num ? quantile(magnitudes, 0.95) : NaN,
  };
}

/** The number of distances with a magnitude of at most `limit`. */
export function countWithin(distances, limit) {
  let count = 0;
  for (let i = 0; i < distances.length; ++i) count += Math.abs(distances[i]) <= limit;
  return count;
}

/** Counts of distances in equal intervals from -reach to reach. */
export function histogramOf(distances, reach, num) {
  const counts = new Uint32Array(num);
  for (let i = 0; i < distances.length; ++i) {
    if (!(Math.abs(distances[i]) <= reach)) continue;
    const at = Math.floor(((distances[i] + reach) / (2 * reach)) * num);
    counts[Math.min(at, num - 1)] += 1;
  }
  return counts;
}

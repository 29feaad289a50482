/** The extents of scans, and the unit in which a scan has the size of the models. */

/** The extents of a scan along its axes, in its unit. */
export function extents(positions) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < positions.length; ++i) {
    low[i % 3] = Math.min(low[i % 3], positions[i]);
    high[i % 3] = Math.max(high[i % 3], positions[i]);
  }
  return low.map((value, axis) => high[axis] - value);
}

const kMeters = { m: 1, mm: 0.001 };

// The service refuses scans smaller or larger than these multiples of the smallest and the largest
// model's diameter.
const kLeast = 0.05;
const kMost = 500;

/**
 * Whether a different unit would make the scan match the size of the models.
 *
 * positions  points of the scan; unit  the unit in which they were read
 * library    { unit, models: [{ diameter }] }
 * Returns { across: diagonal in either unit, smallest, largest: diameters, in the library's unit,
 *   fitting: the other unit }; null if the unit is not in doubt, or none fits.
 */
export function unitThatFits(positions, unit, library) {
  if (!positions?.length || !library.models.length) return null;
  const across = Math.hypot(...extents(positions));
  const diameters = library.models.map(({ diameter }) => diameter);
  const [smallest, largest] = [Math.min(...diameters), Math.max(...diameters)];
  const fits = (candidate) => {
    const size = (across * kMeters[candidate]) / kMeters[library.unit];
    return size >= kLeast * smallest && size <= kMost * largest;
  };
  const fitting = Object.keys(kMeters).find((other) => other !== unit && fits(other));
  return !fits(unit) && fitting ? { across, smallest, largest, fitting } : null;
}

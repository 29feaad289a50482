const kPerMeter = { m: 1, mm: 1000 };

/** The factor from a length in one unit to another. */
export const unitScale = (from, to) => kPerMeter[to] / kPerMeter[from];

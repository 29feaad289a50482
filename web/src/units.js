const kPerMeter = { m: 1, mm: 1000 };

/** What a length in one unit is multiplied by to be in another. */
export const unitScale = (from, to) => kPerMeter[to] / kPerMeter[from];

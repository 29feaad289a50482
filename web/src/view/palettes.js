import { DataTexture, SRGBColorSpace } from "three";

// The number of colors between the two beyond the limits.
const kSteps = 254;

/**
 * Colors of values, as [red, green, blue] of 0 to 255: below the lower limit, between the limits in
 * equal steps, above the upper one. They are distinct to all viewers, on light and dark
 * backgrounds.
 */
export const kPalettes = {
  /** For deviations: blue below, orange above, and values out of tolerance stand out. */
  deviation: {
    below: [120, 40, 190],
    between: [
      [74, 151, 233],
      [193, 180, 165],
      [253, 141, 2],
    ],
    above: [190, 50, 20],
  },
  /** For lengths. Source: viridis, van der Walt and Smith, 2015, without its darkest part. */
  length: {
    below: [71, 45, 123],
    between: [
      [71, 45, 123],
      [59, 82, 139],
      [44, 114, 142],
      [33, 145, 140],
      [40, 174, 128],
      [94, 201, 98],
      [173, 220, 48],
      [253, 231, 37],
    ],
    above: [253, 231, 37],
  },
};

/** The color of a value between limits, as above. */
export function colorOf({ below, between, above }, value, low, high) {
  if (value < low) return below;
  if (value > high) return above;
  const at = ((value - low) / (high - low)) * (between.length - 1);
  const k = Math.min(Math.floor(at), between.length - 2);
  return between[k].map((from, channel) =>
    Math.round(from + (at - k) * (between[k + 1][channel] - from)),
  );
}

export const cssColor = (color) => `rgb(${color.join(" ")})`;

/** A palette as a row of texels: the colors beyond the limits are the first and the last. */
export class PaletteTexture extends DataTexture {
  constructor() {
    super(new Uint8Array(4 * (kSteps + 2)), kSteps + 2, 1);
    this.colorSpace = SRGBColorSpace;
  }

  set(palette) {
    for (let k = 0; k < kSteps + 2; ++k) {
      // The first value is below 0, the last above 1.
      const value = (k - 0.5) / kSteps;
      this.image.data.set([...colorOf(palette, value, 0, 1), 255], 4 * k);
    }
    this.needsUpdate = true;
  }
}

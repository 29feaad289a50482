import { byId, element } from "./dom.js";
import { lengthWords } from "./words.js";

const kMostPixels = 120;

/**
 * The longest round length (1, 2 or 5 times a power of ten) that covers at most this many pixels.
 */
export function roundLength(lengthPerPixel) {
  const most = kMostPixels * lengthPerPixel;
  const power = 10 ** Math.floor(Math.log10(most));
  return power * [5, 2, 1].find((step) => step * power <= most);
}

/** Shows the scale at the view's target; lengthPerPixel  in the unit, null: nothing is shown. */
export function showScale(lengthPerPixel, unit) {
  const box = byId("scale");
  box.hidden = !(lengthPerPixel > 0);
  if (box.hidden) return;
  const length = roundLength(lengthPerPixel);
  const bar = element("span", { className: "bar" });
  bar.style.width = `${(length / lengthPerPixel).toFixed(1)}px`;
  box.replaceChildren(bar, lengthWords(length, unit));
}

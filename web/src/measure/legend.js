import { byId, element } from "../dom.js";
import { cssColor } from "../view/palettes.js";

/**
 * Shows the legend of the colors in the view.
 *
 * title           of the values
 * labels          of the lower limit, the middle and the upper limit, with units
 * hasBeyond       whether values beyond the limits have separate colors
 */
export function showLegend({ title, labels, palette, hasBeyond }) {
  const { below, between, above } = palette;
  const end = (color) => {
    const made = element("span", { className: "end" });
    made.style.background = cssColor(color);
    return made;
  };
  const ramp = element("span", { className: "ramp" });
  ramp.style.background = `linear-gradient(90deg, ${between.map(cssColor).join(", ")})`;
  const bar = element(
    "span",
    { className: "bar" },
    hasBeyond && end(below),
    ramp,
    hasBeyond && end(above),
  );
  const marks = element(
    "span",
    { className: "labels" },
    labels.map((label) => element("span", {}, label)),
  );
  byId("legend").replaceChildren(element("span", {}, title), bar, marks);
  byId("legend").setAttribute("aria-label", `Colors: ${title}, from ${labels[0]} to ${labels[2]}`);
  byId("legend").classList.toggle("ends", hasBeyond);
}

/** Creates an SVG element. */
export function svg(tag, attributes = {}, text = "") {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.textContent = text;
  return made;
}

const point = ({ x, y }) => `${x.toFixed(1)} ${y.toFixed(1)}`;

/** Path data of lines: [[from, to], …], each { x, y }; null is omitted. */
export const linesData = (lines) =>
  lines
    .filter(Boolean)
    .map(([from, to]) => `M${point(from)}L${point(to)}`)
    .join("");

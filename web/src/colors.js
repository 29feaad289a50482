/**
 * Colors that remain distinct with the common forms of color blindness, those with most contrast to
 * a gray scan first. Source: Okabe, Ito, Color Universal Design, 2008.
 */
const kHues = ["#e69f00", "#56b4e9", "#009e73", "#cc79a7", "#d55e00", "#0072b2", "#f0e442"];

/** Tones for adjacent instances of one model: the hue itself, lighter, darker. */
const kTones = [null, ["#ffffff", 0.3], ["#000000", 0.25]];

function mix(color, other, share) {
  const channel = (text, k) => parseInt(text.slice(1 + 2 * k, 3 + 2 * k), 16);
  const mixed = [0, 1, 2].map((k) =>
    Math.round(channel(color, k) * (1 - share) + channel(other, k) * share),
  );
  return `#${mixed.map((value) => value.toString(16).padStart(2, "0")).join("")}`;
}

/** A color for each detection: a hue for each model that was found, a tone for each instance. */
export function detectionColors(detections) {
  const seen = new Map();
  return detections.map(({ model }) => {
    if (!seen.has(model)) seen.set(model, { hue: kHues[seen.size % kHues.length], count: 0 });
    const { hue, count } = seen.get(model);
    seen.get(model).count += 1;
    const tone = kTones[count % kTones.length];
    return tone ? mix(hue, ...tone) : hue;
  });
}

// Poses with lower scores are not listed.
const kHopeful = 0.01;

/**
 * The rejected poses worth listing, best first: those with a chance that are not just a worse
 * hypothesis for a detection of their model, and the best of each model without a detection.
 */
export function worthTelling(rejected, detections) {
  const seen = new Set(detections.map(({ model }) => model));
  return rejected.filter((pose) => {
    const first = !seen.has(pose.model);
    seen.add(pose.model);
    const beneathItsLike =
      pose.reason === "too_low" && detections[pose.explained_by]?.model === pose.model;
    return first || (pose.score >= kHopeful && !beneathItsLike);
  });
}

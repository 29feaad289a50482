/**
 * The verdicts of rays in a pose's full test, the decisive ones last: { name in answers, words,
 * color }.
 */
export const kVerdicts = [
  { name: "hidden", words: "hidden", color: "#8a8f98" },
  { name: "unmeasured", words: "unmeasured", color: "#f0e442" },
  { name: "background", words: "on a background plane", color: "#56b4e9" },
  { name: "agrees", words: "agrees", color: "#009e73" },
  { name: "runs_on", words: "runs on", color: "#cc79a7" },
  { name: "looked_through", words: "looked through", color: "#d55e00" },
];

/**
 * The number of rays with each verdict: { verdict of kVerdicts, count }, the decisive ones first.
 */
export const countRays = (rays) =>
  kVerdicts
    .map((verdict) => ({ verdict, count: rays[verdict.name].length / 3 }))
    .filter(({ count }) => count > 0)
    .reverse();

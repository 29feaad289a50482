import { element, moveByArrows } from "./dom.js";
import { countRays } from "./rays.js";
import { countWords, scoreWords } from "./words.js";

/** The number of rays with each verdict, with their colors in the view. */
const legend = (rays) =>
  element(
    "span",
    { className: "rays" },
    countRays(rays).map(({ verdict, count }) => {
      const swatch = element("span", { className: "swatch" });
      swatch.style.background = verdict.color;
      return element("span", {}, swatch, `${verdict.words} ${countWords(count)}`);
    }),
  );

// With a lower score, nothing speaks for a model.
const kNothing = 0.05;

/**
 * The verdict about a position in a sentence; models  as explained by the service, minScore  of the
 * request
 */
export function verdictWords(models, minScore) {
  if (!models.length) return "no pose of any model was proposed here.";
  const found = models.find(({ detection }) => detection !== null);
  if (found) return `${found.model}, number ${found.detection + 1}, was found here.`;
  const tested = models.filter(({ pose }) => pose).sort((a, b) => b.pose.score - a.pose.score);
  if (!tested.length) return "no pose got as far as a test by rays here.";
  const [{ model, pose }] = tested;
  const score = scoreWords(pose.score);
  return pose.score < kNothing
    ? `nothing here looks like a model; the best guess, ${model}, has a score of ${score}.`
    : `not sure enough: the best guess, ${model}, has a score of ${score}; the lowest is ${minScore}.`;
}

/** The outcome of each model at a position of the scan. */
export class WhyList {
  #list;
  #buttons = new Map();

  /** list  an `ol`; onOpen(id) is called when a row is opened, onOpen(null) when it is closed */
  constructor(list, onOpen) {
    this.#list = list;
    this.onOpen = onOpen;
    moveByArrows(list, "button.pose");
  }

  /** things  [{ id: of its drawing in the view, explained: from the service }] */
  show(things) {
    this.#buttons.clear();
    this.#list.replaceChildren(
      ...things.map(({ id, explained }) => {
        const score = explained.pose?.score;
        const told = [
          element("span", { className: "name" }, explained.model),
          score !== undefined &&
            element(
              "span",
              { className: "score" },
              element("span", { className: "unseen" }, "score "),
              scoreWords(score),
            ),
          element(
            "span",
            { className: "note" },
            explained.words,
            element("br"),
            element("span", { className: "dim" }, explained.stage_words),
            id && legend(explained.rays),
          ),
        ];
        // Without a pose there is nothing to show.
        if (!id) return element("li", {}, element("div", { className: "pose" }, told));
        const button = element(
          "button",
          {
            type: "button",
            className: "pose",
            "aria-pressed": "false",
            onclick: () => this.onOpen(button.getAttribute("aria-pressed") === "true" ? null : id),
          },
          told,
        );
        this.#buttons.set(button, id);
        return element("li", {}, button);
      }),
    );
  }

  /** Marks the row with this id as the drawn one. */
  open(id) {
    for (const [button, own] of this.#buttons) button.setAttribute("aria-pressed", own === id);
  }
}

import { copyButton } from "./copy.js";
import { element, moveByArrows, terms } from "./dom.js";
import { scoreBars } from "./score_bars.js";
import {
  candidateWords,
  lengthWords,
  methodWords,
  numbered,
  orientationOf,
  percentWords,
  pointWords,
  quaternionWords,
  scoreWords,
  sigmaWords,
  turnWords,
  visibilityWords,
} from "./words.js";

const position = (pose) => pose.T_scene_model.slice(0, 3).map((row) => row[3]);

function noteOf({ kind, pose, reason }, unit) {
  if (kind === "rejected") return reason;
  return `${visibilityWords(pose)}, rmse ${lengthWords(pose.rmse, unit)}`;
}

function detailsOf({ kind, pose }, { unit, scoreParts, aboutPose }) {
  const found = kind === "found";
  const orientation = orientationOf(pose.T_scene_model);
  return [
    terms([
      ["position", `${pointWords(position(pose), unit)} in the scan's frame`],
      ["turned by", turnWords(orientation)],
      ["quaternion", `${quaternionWords(orientation)} (x, y, z, w)`],
      pose.pose_sigma && ["how sure", sigmaWords(pose.pose_sigma, unit)],
      found && ["outline free", percentWords(pose.contour)],
      found && ["looked through", percentWords(pose.violation)],
      found && ["proposed by", methodWords(pose.method)],
      found && pose.words && ["costs it most", pose.words],
      pose.alternatives?.length > 0 && [
        "ambiguous",
        `the scan cannot tell it from ${numbered(pose.alternatives.length, "other pose", "other poses")},` +
          " drawn as outlines",
      ],
      pose.candidates?.length > 1 && [
        `one of ${pose.candidates.length}`,
        pose.candidates.map((candidate) => candidateWords(candidate, unit)).join(". "),
      ],
    ]),
    found && aboutPose(pose),
    pose.evidence && scoreParts && scoreBars(pose, scoreParts),
    element(
      "p",
      { className: "buttons" },
      copyButton("Copy matrix", JSON.stringify(pose.T_scene_model)),
    ),
  ].flat();
}

/** A list of posed models. One at a time is open, with its details below. */
export class PoseList {
  #list;
  #rows = new Map();

  #moreFor;

  /**
   * list     an `ol`
   * onOpen   onOpen(id) is called when a row is opened, onOpen(null) when it is closed
   * moreFor  moreFor(id) returns an element to show below a row, or null
   */
  constructor(list, onOpen, moreFor = () => null) {
    this.#list = list;
    this.onOpen = onOpen;
    this.#moreFor = moreFor;
    moveByArrows(list, "button.pose");
  }

  /**
   * things  [{ id, kind, label, color, pose: from the service, reason }]
   * about   { unit: of the scan, scoreParts: of the service, or null, aboutPose: aboutPose(pose)
   *         returns an element about a detection }
   */
  show(things, about) {
    this.#rows.clear();
    const rows = things.map((thing) => {
      const details = element("div", {
        className: "details",
        hidden: true,
        id: `about-${thing.id}`,
      });
      const swatch = element("span", { className: `swatch ${thing.kind}`, "aria-hidden": "true" });
      if (thing.color) swatch.style.background = thing.color;
      const meter = element("span", { className: "meter", "aria-hidden": "true" });
      meter.style.setProperty("--score", thing.pose.score);
      const button = element(
        "button",
        {
          type: "button",
          className: "pose",
          "aria-expanded": "false",
          "aria-controls": details.id,
          onclick: () =>
            this.onOpen(button.getAttribute("aria-expanded") === "true" ? null : thing.id),
        },
        swatch,
        element("span", { className: "label" }, thing.label),
        element(
          "span",
          { className: "name" },
          thing.pose.model,
          " ",
          thing.pose.ambiguous && element("span", { className: "tag" }, "ambiguous"),
        ),
        element(
          "span",
          { className: "score" },
          element("span", { className: "unseen" }, "score "),
          scoreWords(thing.pose.score),
        ),
        element("span", { className: "note dim" }, noteOf(thing, about.unit)),
        meter,
      );
      const fill = () =>
        details.replaceChildren(...detailsOf(thing, about).filter(Boolean));
      this.#rows.set(thing.id, { button, details, fill });
      return element("li", {}, button, this.#moreFor(thing.id), details);
    });
    this.#list.replaceChildren(...rows);
  }

  /** Updates the open details. */
  refresh() {
    for (const { details, fill } of this.#rows.values()) if (!details.hidden) fill();
  }

  /** Opens the row with this id, and closes the others; null or an unknown id: closes all. */
  open(id) {
    for (const [other, { button, details, fill }] of this.#rows) {
      const opens = other === id;
      button.setAttribute("aria-expanded", opens);
      details.hidden = !opens;
      if (!opens) continue;
      fill();
      button.closest("li").scrollIntoView({ block: "nearest" });
    }
  }
}

import { byId, element } from "../dom.js";
import { numbered } from "../words.js";

/** Marks of detections as right or wrong, by buttons in the rows or by keys. */
export class Marks {
  // The rows by the ids of the detections.
  #rows = new Map();
  #shown = null;

  /** onMark(marks) is called with { index: true, false or null }. */
  constructor(onMark) {
    this.onMark = onMark;
    byId("all-right").onclick = () => this.markAll();
  }

  get isOn() {
    return this.#shown !== null;
  }

  /** Buttons for the row of a detection; null if no kept answer is shown. */
  buttonsFor(id) {
    if (!this.isOn) return null;
    const index = Number(id.split("-")[1]);
    const make = (right, text) =>
      element(
        "button",
        {
          type: "button",
          className: "verdict",
          "aria-pressed": "false",
          onclick: () => this.#toggle(index, right),
        },
        text,
      );
    const buttons = { right: make(true, "Right"), wrong: make(false, "Wrong") };
    this.#rows.set(index, buttons);
    return element("p", { className: "verdicts" }, buttons.right, buttons.wrong);
  }

  /** Sets whether the next rows belong to a kept answer. */
  expect(isKept) {
    this.#rows.clear();
    this.#shown = isKept ? [] : null;
    byId("verdicts").hidden = true;
  }

  /**
   * verdicts  of the displayed detections: true, false or null
   * isTold    whether the scan's truth is known
   */
  show(verdicts, isTold) {
    this.#shown = verdicts;
    for (const [index, { right, wrong }] of this.#rows) {
      right.setAttribute("aria-pressed", verdicts[index] === true);
      wrong.setAttribute("aria-pressed", verdicts[index] === false);
    }
    const open = verdicts.filter((verdict) => verdict === null).length;
    const rights = verdicts.filter(Boolean).length;
    byId("verdicts").hidden = false;
    byId("all-right").textContent = verdicts.length ? "Mark the rest as right" : "Nothing is there";
    byId("all-right").disabled = verdicts.length ? !open : isTold;
    byId("verdicts-note").textContent = this.#note(open, rights, isTold);
  }

  #note(open, rights, isTold) {
    if (open) return `${numbered(open, "is not marked", "are not marked")} yet.`;
    const wrongs = this.#shown.length - rights;
    if (this.#shown.length) return `${rights} right, ${wrongs} wrong: kept as the scan’s truth.`;
    return isTold ? "The truth of this scan is kept." : "Nothing is found: is that right?";
  }

  /** Marks the selected detection; id  null: none is selected */
  mark(id, right) {
    if (this.isOn && id?.startsWith("found-")) this.#toggle(Number(id.split("-")[1]), right);
  }

  /** The id of the next unmarked detection; null: there is no other. */
  openAfter(id) {
    if (!this.isOn || !id?.startsWith("found-")) return null;
    const index = Number(id.split("-")[1]);
    const order = [...this.#shown.keys()].sort((a, b) => (a <= index) - (b <= index) || a - b);
    const next = order.find((other) => other !== index && this.#shown[other] === null);
    return next === undefined ? null : `found-${next}`;
  }

  /** Marks all unmarked detections as right. */
  markAll() {
    if (!this.isOn || byId("all-right").disabled) return;
    const open = this.#shown.flatMap((verdict, index) => (verdict === null ? [index] : []));
    this.onMark(Object.fromEntries(open.map((index) => [index, true])));
  }

  #toggle(index, right) {
    this.onMark({ [index]: this.#shown[index] === right ? null : right });
  }
}

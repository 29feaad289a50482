import { element } from "../dom.js";

const kAxes = ["x", "y", "z"];

// The names of the rows of numbers in a list.
const kRows = {
  region: [
    ["from", kAxes],
    ["to", kAxes],
  ],
  tilt: [
    ["model’s direction", kAxes],
    ["scan’s direction", kAxes],
    ["within", ["°"]],
  ],
  explain: [["at", kAxes]],
};
// These are in the unit of the scan.
const kLengths = ["region", "explain"];
const numbered = (count) => [["", Array.from({ length: count }, (_, k) => String(k + 1))]];

/** A fixed number of numbers, or none. */
export class NumbersField {
  #inputs = [];
  #unit = element("span");

  /** label  of all numbers together */
  constructor({ name, schema }, label) {
    const rows = (kRows[name] ?? numbered(schema.maxItems)).map(([words, columns]) =>
      element(
        "div",
        { className: "numbers" },
        element("span", { className: "dim" }, words),
        columns.map((column) => this.#input(label, words, column)),
      ),
    );
    const legend = element("legend", {}, label, kLengths.includes(name) && this.#unit);
    this.element = element("fieldset", { name }, legend, rows);
  }

  #input(label, words, column) {
    const input = element("input", {
      type: "number",
      step: "any",
      placeholder: column,
      "aria-label": [label, words, column].filter(Boolean).join(" "),
    });
    this.#inputs.push(input);
    return input;
  }

  /** Unit of the scan. */
  set unit(unit) {
    this.#unit.textContent = ` [${unit}]`;
  }

  get text() {
    const texts = this.#inputs.map((input) => (input.validity.badInput ? "?" : input.value));
    return texts.every((text) => text === "") ? "" : texts.join(",");
  }

  set text(text) {
    const numbers = text.split(",");
    this.#inputs.forEach((input, k) => (input.value = numbers[k] ?? ""));
  }
}

/**
 * Editors of one value. Each has an `element`, which the form finds by the parameter's name, and a
 * `text`, as in a query; "": no value.
 */
import { element } from "../dom.js";

export class NumberField {
  constructor({ name, schema }) {
    this.element = element("input", {
      name,
      type: "number",
      min: schema.minimum ?? schema.exclusiveMinimum ?? "",
      max: schema.maximum ?? "",
      step: schema.type === "integer" ? 1 : "any",
    });
  }

  /** A text that is not a number stays unchanged and is reported as a fault. */
  get text() {
    return this.element.validity.badInput ? "no number" : this.element.value;
  }

  set text(text) {
    this.element.value = text;
  }

  showUsual(words) {
    this.element.placeholder = words;
  }
}

export class ChoiceField {
  constructor({ name, schema }) {
    const choices = schema.enum.map((value) => element("option", { value }, value));
    this.element = element("select", { name }, choices);
  }

  get text() {
    return this.element.value;
  }

  set text(text) {
    this.element.value = text;
  }
}

export class FlagField {
  constructor({ name }) {
    this.element = element("input", { name, type: "checkbox" });
  }

  get text() {
    return String(this.element.checked);
  }

  set text(text) {
    this.element.checked = text === "true";
  }
}

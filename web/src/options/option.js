import { element } from "../dom.js";
import { ChoiceField, FlagField, NumberField } from "./fields.js";
import { NameList } from "./name_list.js";
import { NumbersField } from "./numbers_field.js";
import { faultOf, helpOf, kindOf, labelOf, usualOf, usualWords } from "./parameter.js";

const kFields = {
  choice: ChoiceField,
  boolean: FlagField,
  number: NumberField,
  integer: NumberField,
  numbers: NumbersField,
  names: NameList,
};
const kFlags = { true: "on", false: "off" };

/** One parameter and its position in the form: a field with its name, its meaning and a reset. */
export class Option {
  #parameter;
  #field;
  #usual;
  #reset = element("button", { type: "button", className: "plain", hidden: true });

  /** onReset()  is called after the user resets the parameter */
  constructor(parameter, onReset) {
    this.#parameter = parameter;
    const label = labelOf(parameter);
    this.#field = new kFields[kindOf(parameter)](parameter, label);
    if (this.#field.names) this.#field.names = parameter.schema.items.enum ?? [];
    const { element: edits } = this.#field;
    const help = element("p", { className: "help dim", id: `help-${this.name}` }, helpOf(parameter));
    edits.setAttribute("aria-describedby", help.id);
    this.#reset.onclick = () => {
      this.text = "";
      // The button, which had the focus, is hidden now.
      this.input.focus();
      onReset();
    };
    const isList = edits.matches("fieldset");
    if (isList) edits.append(help, this.#reset);
    this.row = element(
      "div",
      { className: "option" },
      isList ? edits : [element("label", {}, element("span", {}, label), edits), help, this.#reset],
    );
    this.words = [label, this.name, help.textContent].join(" ").toLowerCase();
    this.takeUsual();
  }

  get name() {
    return this.#parameter.name;
  }

  get group() {
    return this.#parameter["x-group"];
  }

  /** The displayed text, even if no value is set. */
  get shown() {
    return this.#field.text;
  }

  /** The element that receives the focus. */
  get input() {
    const { element: edits } = this.#field;
    return edits.matches("fieldset") ? edits.querySelector("input:not([hidden])") : edits;
  }

  /** Whether the value differs from the default. */
  get isSet() {
    const { text } = this.#field;
    // A choice always shows a value. A typed value is intended, even if it equals the default.
    return text !== "" && (this.#isTyped || text !== this.#usual);
  }

  get #isTyped() {
    return !["choice", "boolean"].includes(kindOf(this.#parameter));
  }

  /** The value as in a query; "": the default. */
  get text() {
    return this.isSet ? this.#field.text : "";
  }

  set text(text) {
    this.#field.text = text === "" && !this.#isTyped ? this.#usual : text;
    this.mark();
  }

  /** Unit of the scan. */
  set unit(unit) {
    this.#field.unit = unit;
  }

  /** The available names of a list of names. */
  set names(names) {
    this.#field.names = names;
    this.mark();
  }

  /** The fault of a text, as a sentence; null: none. */
  faultOf(text) {
    return faultOf(this.#parameter, text, this.#field.names);
  }

  get fault() {
    return this.isSet ? this.faultOf(this.#field.text) : null;
  }

  /** Uses another default, or the parameter's default; a set value stays. */
  takeUsual(usual = usualOf(this.#parameter)) {
    if (usual === this.#usual) return;
    const wasSet = this.#usual !== undefined && this.isSet;
    this.#usual = usual;
    const words = usual === "" ? usualWords(this.#parameter) : (kFlags[usual] ?? usual);
    this.#field.showUsual?.(words);
    this.#reset.textContent = `Reset to ${words}`;
    this.#reset.setAttribute("aria-label", `Reset ${labelOf(this.#parameter)} to ${words}`);
    if (!wasSet) this.text = "";
  }

  /** Shows whether the option is set. */
  mark() {
    this.row.classList.toggle("set", this.isSet);
    this.#reset.hidden = !this.isSet;
  }
}

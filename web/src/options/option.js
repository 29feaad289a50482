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

/** One parameter, and its place in the form: a field with its name, what it means, and a reset. */
export class Option {
  #parameter;
  #field;
  #usual;
  #reset = element("button", { type: "button", className: "plain", hidden: true });

  /** onReset()  is called after the user took it back */
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
      this.input.focus(); // what had the focus is gone
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

  /** What the form shows, also where nothing is set. */
  get shown() {
    return this.#field.text;
  }

  /** What takes the focus. */
  get input() {
    const { element: edits } = this.#field;
    return edits.matches("fieldset") ? edits.querySelector("input:not([hidden])") : edits;
  }

  /** Whether it says something else than what is usual. */
  get isSet() {
    const { text } = this.#field;
    // A choice always shows something; what was typed is meant, also where it is the usual.
    return text !== "" && (this.#isTyped || text !== this.#usual);
  }

  get #isTyped() {
    return !["choice", "boolean"].includes(kindOf(this.#parameter));
  }

  /** As in a query; "": as usual. */
  get text() {
    return this.isSet ? this.#field.text : "";
  }

  set text(text) {
    this.#field.text = text === "" && !this.#isTyped ? this.#usual : text;
    this.mark();
  }

  /** Of the scan. */
  set unit(unit) {
    this.#field.unit = unit;
  }

  /** Of a list of names: those that there are. */
  set names(names) {
    this.#field.names = names;
    this.mark();
  }

  /** What is wrong with a text, as a sentence; null: nothing. */
  faultOf(text) {
    return faultOf(this.#parameter, text, this.#field.names);
  }

  get fault() {
    return this.isSet ? this.faultOf(this.#field.text) : null;
  }

  /** Take another default, else the parameter's own; what was set stays. */
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

  /** Show whether it is set. */
  mark() {
    this.row.classList.toggle("set", this.isSet);
    this.#reset.hidden = !this.isSet;
  }
}

import { byId, element } from "../dom.js";
import { numbered } from "../words.js";
import { Option } from "./option.js";

// The other groups are for research.
const kOpen = ["Answers", "What is searched"];

/** The options of recognition without a dedicated field in the form, below headings. */
export class Options {
  #presets;
  #groups = [];
  #all = new Map();
  #isNarrow = false;

  /**
   * parameters  as described by the service
   * models      names of the library's models
   * onChange()  is called after the page changes an option; the form reports the user's changes
   */
  constructor(parameters, models, onChange) {
    this.onChange = onChange;
    for (const parameter of parameters) this.#add(parameter);
    this.#presets = parameters.find(({ name }) => name === "preset")["x-presets"];
    this.models = models;
    byId("options").replaceChildren(...this.#groups.map(({ box }) => box));
    // Delayed during typing: a mark that appears would move buttons from under the pointer.
    byId("options").addEventListener("input", () => this.#arrange());
    const search = byId("option-search");
    search.addEventListener("input", () => this.#narrow(search.value));
    byId("options-box").addEventListener("keydown", (event) => {
      if (event.key === "Enter" && event.target.type === "search") event.preventDefault();
    });
    byId("options-reset").onclick = () => {
      this.reset();
      search.focus();
      this.onChange();
    };
    byId("options-explain").onclick = ({ target }) => {
      const explains = byId("options").classList.toggle("explained");
      target.setAttribute("aria-expanded", explains);
    };
    this.#arrange();
  }

  #add(parameter) {
    const option = new Option(parameter, () => {
      this.#arrange();
      this.onChange();
    });
    this.#all.set(option.name, option);
    let group = this.#groups.find(({ name }) => name === option.group);
    if (!group) {
      const count = element("span", { className: "dim" });
      const rows = element("div", { className: "rows" });
      const summary = element("summary", {}, option.group, count);
      const box = element("details", { open: kOpen.includes(option.group) }, summary, rows);
      group = { name: option.group, box, rows, count, options: [], isOpen: box.open };
      this.#groups.push(group);
    }
    group.options.push(option);
    group.rows.append(option.row);
  }

  /** Names of the library's models. */
  set models(names) {
    for (const name of ["models", "model"]) this.#all.get(name).names = names;
    this.#arrange();
  }

  /** Unit of the scan. */
  set unit(unit) {
    for (const option of this.#all.values()) option.unit = unit;
  }

  /** undefined: no option with this name */
  get(name) {
    return this.#all.get(name);
  }

  /** Sets an option, as in a query; "": the default. */
  set(name, text) {
    this.#all.get(name).text = text;
    this.#arrange();
    this.onChange();
  }

  /** Resets all options. */
  reset() {
    for (const option of this.#all.values()) option.text = "";
    this.#arrange();
  }

  /** [name, value] of each option that is set. */
  changed() {
    return [...this.#all.values()]
      .filter((option) => option.isSet)
      .map(({ name, text }) => [name, text]);
  }

  /** The first option with an invalid value, and the fix: { field, message }; null: none. */
  fault() {
    const wrong = [...this.#all.values()].find((option) => option.fault);
    return wrong ? { field: wrong.input, message: wrong.fault } : null;
  }

  /** Makes an option visible. */
  open(field) {
    const group = this.#groups.find(({ box }) => box.contains(field));
    if (!group) return;
    byId("options-box").open = true;
    group.box.open = true;
  }

  /** Applies the preset's defaults, and shows which options are set. */
  #arrange() {
    const preset = this.#presets[this.#all.get("preset").shown];
    for (const option of this.#all.values()) {
      option.takeUsual(option.name in preset ? String(preset[option.name]) : undefined);
      option.mark();
    }
    for (const { count, options } of this.#groups) {
      const set = options.filter((option) => option.isSet).length;
      count.textContent = set ? `${set} changed` : "";
    }
    const all = this.changed().length;
    byId("options-count").textContent = all ? `${all} changed` : "";
    byId("options-reset").hidden = !all;
  }

  /** Shows only the options that match all words. */
  #narrow(text) {
    const words = text.toLowerCase().split(/\s+/).filter(Boolean);
    let found = 0;
    for (const group of this.#groups) {
      const { box, options } = group;
      let here = 0;
      for (const { row, words: own } of options) {
        row.hidden = !words.every((word) => own.includes(word));
        here += !row.hidden;
      }
      box.hidden = !here;
      if (words.length && !this.#isNarrow) group.isOpen = box.open;
      box.open = words.length ? true : group.isOpen;
      found += here;
    }
    this.#isNarrow = words.length > 0;
    byId("options-found").textContent = words.length ? numbered(found, "option", "options") : "";
  }
}

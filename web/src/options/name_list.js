import { element, moveByArrows } from "../dom.js";

// The search field is shown for more names than these.
const kFew = 8;

/** Names with check boxes; none checked: the default. */
export class NameList {
  #list = element("ul", { className: "names" });
  #count = element("p", { className: "dim", role: "status" });
  #search = element("input", { type: "search", autocomplete: "off", placeholder: "part of a name" });
  #boxes = [];
  #usual = "";

  constructor({ name }, label) {
    this.#search.setAttribute("aria-label", `${label}: find a name`);
    this.#search.addEventListener("input", () => this.#narrow());
    this.#list.addEventListener("input", () => this.#tell());
    this.element = element(
      "fieldset",
      { name },
      element("legend", {}, label),
      this.#count,
      this.#search,
      this.#list,
    );
    moveByArrows(this.#list, "input");
  }

  get names() {
    return this.#boxes.map(({ value }) => value);
  }

  /** Checked names stay checked if they still exist. */
  set names(names) {
    const ticked = this.text.split(",");
    this.#boxes = names.map((value) =>
      element("input", { type: "checkbox", value, checked: ticked.includes(value) }),
    );
    this.#list.replaceChildren(
      ...this.#boxes.map((box) => element("li", {}, element("label", {}, box, box.value))),
    );
    this.#search.hidden = names.length <= kFew;
    this.#tell();
  }

  get text() {
    return this.#boxes
      .filter(({ checked }) => checked)
      .map(({ value }) => value)
      .join(",");
  }

  set text(text) {
    const ticked = text.split(",");
    for (const box of this.#boxes) box.checked = ticked.includes(box.value);
    this.#tell();
  }

  showUsual(words) {
    this.#usual = words;
    this.#tell();
  }

  #tell() {
    const count = this.#boxes.filter(({ checked }) => checked).length;
    this.#count.textContent = count ? `${count} of ${this.#boxes.length}` : this.#usual;
  }

  #narrow() {
    const wanted = this.#search.value.trim().toLowerCase();
    for (const box of this.#boxes) {
      box.closest("li").hidden = !box.value.toLowerCase().includes(wanted);
    }
  }
}

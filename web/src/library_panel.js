import { byId, element, moveByArrows } from "./dom.js";
import { lengthWords, numbered, symmetryWords } from "./words.js";

/** The models of the library: a list to filter; a click shows one in the view. */
export class LibraryPanel {
  #list = byId("model-list");
  #filter = byId("filter");
  #rows = [];

  /** onShow(model) is called when the user picks one. */
  constructor(onShow) {
    this.onShow = onShow;
    this.#filter.addEventListener("input", () => this.#narrow());
    moveByArrows(this.#list, "button");
  }

  /** library  { unit, models } */
  show({ unit, models }) {
    this.#rows = models.map((model) => {
      const picture = model.thumbnail
        ? element("img", { src: model.thumbnail, alt: "", loading: "lazy", width: 72, height: 72 })
        : element("span", { className: "no-picture" });
      const button = element(
        "button",
        { type: "button", onclick: () => this.onShow(model) },
        picture,
        element("span", { className: "name" }, model.name),
        element(
          "span",
          { className: "dim" },
          `${lengthWords(model.diameter, unit)} across, ${symmetryWords(model.symmetry)}`,
        ),
      );
      return { model, button, item: element("li", {}, button) };
    });
    this.#list.replaceChildren(...this.#rows.map(({ item }) => item));
    this.#narrow();
  }

  /** Mark the model that the view shows; null: none. */
  mark(shown) {
    for (const { model, button } of this.#rows) {
      if (model === shown) button.setAttribute("aria-current", "true");
      else button.removeAttribute("aria-current");
    }
  }

  focus() {
    this.#filter.focus();
  }

  #narrow() {
    const wanted = this.#filter.value.trim().toLowerCase();
    let count = 0;
    for (const { model, item } of this.#rows) {
      item.hidden = !model.name.toLowerCase().includes(wanted);
      count += !item.hidden;
    }
    const all = numbered(this.#rows.length, "model", "models");
    byId("models-count").textContent = wanted ? `${count} of ${all}` : all;
  }
}

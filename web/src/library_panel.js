import { copyButton } from "./copy.js";
import { byId, element, moveByArrows } from "./dom.js";
import { declarationWith, nearTurnsView } from "./near_turns.js";
import { fetchNearTurnsOfModel, showPicture } from "./service.js";
import { lengthWords, numbered, symmetryWords } from "./words.js";

const kAdvice =
  "Where a scan does not show what tells these poses apart, a detection is ambiguous and its score " +
  "lower. If it does not matter to you which one it is, put the declaration of a turn into the " +
  "model’s entry of the manifest that you train from, and none is asked for.";

/** The manifest entries that declare a near symmetry in addition to the known ones. */
const entriesWith = (model, turn) => JSON.stringify(declarationWith(model, turn)).slice(1, -1);

/** The models of the library in a list with a filter; a click shows a model in the view. */
export class LibraryPanel {
  #list = byId("model-list");
  #filter = byId("filter");
  #rows = [];

  /**
   * onShow(model, turn)      is called when the user selects a model or one of its near symmetries
   * onRename(name, to), onRemove(name)  are called if the service allows changes
   */
  constructor({ onShow, onRename, onRemove }) {
    this.onShow = onShow;
    this.onRename = onRename;
    this.onRemove = onRemove;
    this.#filter.addEventListener("input", () => this.#narrow());
    moveByArrows(this.#list, "button.model");
  }

  /** library  { unit, models }; mayChange  whether models may be renamed and removed */
  show({ unit, models }, mayChange) {
    this.#rows = models.map((model) => {
      const picture = model.thumbnail
        ? showPicture(
            element("img", { alt: "", loading: "lazy", width: 72, height: 72 }),
            model.thumbnail,
          )
        : element("span", { className: "no-picture" });
      const button = element(
        "button",
        { type: "button", className: "model", onclick: () => this.onShow(model) },
        picture,
        element("span", { className: "name" }, model.name),
        element(
          "span",
          { className: "dim" },
          `${lengthWords(model.diameter, unit)} across, ${symmetryWords(model.symmetry)}`,
        ),
      );
      const near = nearTurnsView(model, kAdvice, {
        fetchTurns: () => fetchNearTurnsOfModel(model.name),
        unit,
        onShow: (turn) => this.onShow(model, turn),
        actionOf: (turn) => copyButton("Copy declaration", entriesWith(model, turn)),
      });
      const item = element("li", {}, button, near, mayChange && this.#changes(model));
      return { model, button, item };
    });
    this.#list.replaceChildren(...this.#rows.map(({ item }) => item));
    this.#narrow();
  }

  #changes({ name }) {
    const to = element("input", {
      type: "text",
      value: name,
      autocomplete: "off",
      "aria-label": `New name of ${name}`,
    });
    const button = (label, onclick) =>
      element("button", { type: "button", "aria-label": `${label} ${name}`, onclick }, label);
    return element(
      "details",
      { className: "change" },
      element("summary", { "aria-label": `Rename or remove ${name}` }, "Rename or remove"),
      to,
      element(
        "p",
        { className: "buttons" },
        button("Rename", () => this.onRename(name, to.value.trim())),
        button("Remove", () => {
          if (confirm(`Remove ${name} from the library?`)) this.onRemove(name);
        }),
      ),
    );
  }

  /** Marks the model shown in the view; null: none. */
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

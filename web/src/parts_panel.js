import { byId, element } from "./dom.js";
import { declarationWith, deviationWords, nearTurnsView, nearTurnWords } from "./near_turns.js";
import { kPartFormats } from "./scan.js";
import * as service from "./service.js";
import { countWords, lengthWords, numbered, secondsWords, symmetryWords } from "./words.js";

const kPollMs = 700;
// The longest name in bytes of UTF-8.
const kMostName = 128;
const kAboutNear =
  "Where a scan does not show what tells these poses apart, a detection is ambiguous and its score " +
  "lower. Declare a turn only if it does not matter to you by how much it is off.";

/** The model name for a file, the same as in `trivet train`. */
export function modelNameOf(file) {
  const stem = file.replace(/\.gz$/i, "").replace(/\.[^.]*$/, "");
  const named = stem
    .replace(/[^\p{L}\p{M}\p{N}._-]+/gu, "_")
    .replace(/\.{2,}/g, ".")
    .replace(/^[._-]+/, "");
  const bytes = new TextEncoder();
  let name = "";
  for (const character of named) {
    if (bytes.encode(name + character).length > kMostName) break;
    name += character;
  }
  return name.replace(/[._-]+$/, "") || "model";
}

/** The state of a part, in a sentence. */
function stateWords({ state, seconds, error }) {
  if (state === "waiting") return "waits for others";
  if (state === "training") return `training for ${secondsWords(seconds)} …`;
  return state === "failed" ? error : `trained in ${secondsWords(seconds)}`;
}

function factsWords({ facts, model }, unit) {
  const surface = facts.triangles
    ? numbered(facts.triangles, "triangle", "triangles")
    : `a cloud of ${countWords(facts.vertices)} points`;
  return [
    `${lengthWords(model.diameter, unit)} across`,
    surface,
    model.symmetry.declared ? `${symmetryWords(model.symmetry)}, as declared` : symmetryWords(model.symmetry),
  ]
    .filter(Boolean)
    .join(", ");
}

/** Parts uploaded to the service, which trains them aside; the user inspects and publishes them. */
export class PartsPanel {
  #section = byId("parts-section");
  #list = byId("part-list");
  #unit = "m";
  #poll = 0;
  #told = "";
  #parts = [];
  // The models of the library.
  #models = [];
  // The largest file [byte].
  #limit = 0;
  // By part, the declaration before the current one.
  #before = new Map();

  /** Whether the service trains parts. */
  allowed = false;

  /**
   * handlers  onShow(part, turn): draws a trained part and its image under a near symmetry;
   *           onPublished(): the library changed
   */
  constructor({ onShow, onPublished }) {
    this.onShow = onShow;
    this.onPublished = onPublished;
    const chooser = byId("part-files");
    chooser.accept = kPartFormats.map((format) => `.${format}`).join(",");
    chooser.addEventListener("change", () => {
      this.bring([...chooser.files]);
      chooser.value = "";
    });
    byId("add-part").onclick = () => chooser.click();
  }

  /** Requests the settings and parts of the service. */
  start() {
    return this.#look();
  }

  /** Unit of the library. */
  set unit(unit) {
    this.#unit = unit;
    byId("part-unit").value = unit;
  }

  /** Current models of the library. */
  set models(models) {
    this.#models = models;
    this.#show(this.#parts);
  }

  /** Uploads files to be trained as parts. */
  async bring(files) {
    for (const file of files) {
      await this.#act(() => {
        if (file.size > this.#limit) {
          const words = (bytes) => `${countWords(Math.ceil(bytes / 1e6))} MB`;
          throw new Error(`${file.name}: expected at most ${words(this.#limit)}, found ${words(file.size)}.`);
        }
        const unit = byId("part-unit").value;
        return service.bringPart(modelNameOf(file.name), file, unit);
      });
    }
  }

  /** Performs an action, and shows its error or its outcome. */
  async #act(act) {
    const problem = byId("parts-problem");
    problem.textContent = "";
    byId("parts-note").textContent = "";
    try {
      await act();
    } catch (error) {
      problem.textContent = error.message;
    }
    await this.#look();
  }

  async #look() {
    clearTimeout(this.#poll);
    const told = await service.fetchParts();
    this.allowed = told.allowed;
    this.#section.hidden = !told.allowed;
    if (!told.allowed) return;
    this.#limit = told.max_bytes;
    this.#show(told.parts);
    const isBusy = told.parts.some(({ state }) => state === "waiting" || state === "training");
    if (isBusy) this.#poll = setTimeout(() => this.#look().catch(() => {}), kPollMs);
  }

  #show(parts) {
    this.#parts = parts;
    const told = JSON.stringify([parts, this.#models.map(({ name }) => name)]);
    // An unchanged list stays, and so does the focus in it.
    if (told === this.#told) return;
    this.#told = told;
    const focused = document.activeElement?.id;
    this.#list.replaceChildren(...parts.map((part) => this.#row(part)));
    if (focused?.startsWith("part-")) byId(focused)?.focus();
  }

  #row(part) {
    const { name, state, facts, model } = part;
    const button = (label, id, onclick, className = "") =>
      element("button", { type: "button", id: `part-${id}-${name}`, className, onclick, "aria-label": `${label} ${name}` }, label);
    const isTrained = state === "trained";
    const old = this.#models.find((other) => other.name === name);
    return element(
      "li",
      { className: `part ${state}` },
      element("p", { className: "name" }, name),
      element("p", { className: "dim" }, `${part.file}, in ${part.unit}: ${stateWords(part)}`),
      isTrained && element("p", {}, `${factsWords(part, this.#unit)}.`),
      isTrained && old &&
        element("p", { className: "warning" }, `The library has a ${name}, ${lengthWords(old.diameter, this.#unit)} across: this replaces it.`),
      isTrained && this.#near(part),
      isTrained && facts.warnings.map((words) => element("p", { className: "warning" }, words)),
      element(
        "p",
        { className: "buttons" },
        isTrained && button("Show", "show", () => this.onShow(part)),
        isTrained && model.symmetry.declared && button("Undo declaration", "undo", () => this.#undo(name)),
        isTrained &&
          button(old ? "Replace" : "Publish", "publish", () => this.#act(() => this.#publish(part, old)), "primary"),
        button(isTrained || state === "failed" ? "Discard" : "Stop", "drop", () =>
          this.#act(() => service.dropPart(name)),
        ),
      ),
    );
  }

  /** The near symmetries of a part, each with a button to declare it. */
  #near(part) {
    const { name, model } = part;
    const declare = (turn) => {
      const words =
        `Declare that ${name} looks the same turned by ${nearTurnWords(turn)}?\n` +
        `It is then ${deviationWords(turn, this.#unit)}. Poses that differ by this turn count as ` +
        "one, and a detection may be any of them.";
      if (!confirm(words)) return;
      const { declared, declaration } = model.symmetry;
      this.#before.set(name, [...(this.#before.get(name) ?? []), declared ? declaration : null]);
      this.#declare(name, declarationWith(model, turn));
    };
    return nearTurnsView(model, kAboutNear, {
      fetchTurns: () => service.fetchNearTurnsOfPart(name),
      unit: this.#unit,
      onShow: (turn) => this.onShow(part, turn),
      actionOf: (turn) =>
        element("button", { type: "button", onclick: () => declare(turn) }, "Declare this turn"),
    });
  }

  #declare(name, declaration) {
    return this.#act(() => service.declarePart(name, declaration));
  }

  /** Reverts the last declaration known to this page; otherwise reverts all of them. */
  #undo(name) {
    return this.#declare(name, this.#before.get(name)?.pop() ?? null);
  }

  /** old  the model to replace, if there is one */
  async #publish({ name, facts }, old) {
    const doubts = [...facts.warnings, old && `${name} of the library is replaced.`].filter(Boolean);
    if (doubts.length && !confirm(`${doubts.join("\n")}\nPublish it?`)) return;
    await service.publishPart(name);
    await this.onPublished();
    byId("parts-note").textContent = `${name} is in the library, and looked for from now on.`;
  }
}

import { byId } from "./dom.js";
import { askWhetherAlive } from "./service.js";

/** Pause between requests: with the duration of one, silence is reported within two seconds. */
export const kRestMs = 600;

/** Checks continuously whether the service responds, and shows a banner when it does not. */
export class Pulse {
  #banner = byId("away");
  #next = 0;

  start() {
    byId("away-retry").onclick = () => this.#look();
    document.addEventListener("visibilitychange", () => this.#look());
    this.#look();
  }

  async #look() {
    clearTimeout(this.#next);
    // A hidden page asks again as soon as it is visible.
    if (document.hidden) return;
    let answers = true;
    try {
      await askWhetherAlive();
    } catch (error) {
      // A refusal is an answer, too: a proxy may not allow the question.
      answers = error.status > 0;
    }
    this.#tell(answers);
    // Another question may have been asked meanwhile.
    clearTimeout(this.#next);
    this.#next = setTimeout(() => this.#look(), kRestMs);
  }

  #tell(answers) {
    if (this.#banner.hidden === answers) return;
    this.#banner.hidden = answers;
    byId("away-words").textContent = answers
      ? ""
      : "The service does not answer: what is shown is from before. Is `trivet serve` still running?";
  }
}

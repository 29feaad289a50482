import { byId } from "./dom.js";
import { askWhetherAlive } from "./service.js";

/** Between questions: with the time of one, silence is told within two seconds. */
export const kRestMs = 600;

/** Asks the service all the time whether it is there, and tells in a banner when it is not. */
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
    if (document.hidden) return; // nobody looks; it is asked again at once when somebody does
    let answers = true;
    try {
      await askWhetherAlive();
    } catch (error) {
      answers = error.status > 0; // a proxy may refuse to be asked
    }
    this.#tell(answers);
    clearTimeout(this.#next); // of a question that was asked meanwhile
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

import { byId, element, moveByArrows } from "./dom.js";
import { scanOfExample } from "./scan.js";
import * as service from "./service.js";
import { numbered, secondsWords } from "./words.js";

const kPollMs = 500;
const kMost = 100;

/**
 * The latest scans of the folder watched by the service; the newest is shown in the view on
 * arrival.
 */
export class LiveStrip {
  #list = byId("live-scans");
  #follow = byId("follow");
  // The numbers of scans belong to this epoch of the service.
  #epoch = "";
  // The largest number so far.
  #last = 0;
  // The scan in the view.
  #shown = null;

  /**
   * onOpen(scan, answer)     shows a scan with its kept answer
   * onFailed(scan, reason)   shows why a scan has none
   */
  constructor({ onOpen, onFailed }) {
    this.onOpen = onOpen;
    this.onFailed = onFailed;
    this.#follow.onclick = () => this.toggle();
    moveByArrows(this.#list, "button");
  }

  /** Watches the folder if the service does. Earlier scans are listed. */
  async start() {
    const { watched, epoch, scans } = await service.fetchLive(0);
    byId("live").hidden = !watched;
    if (!watched) return;
    this.#epoch = epoch;
    this.#add(scans);
    setTimeout(() => this.#poll(), kPollMs);
  }

  /** Starts or stops following new scans. */
  toggle() {
    this.#setFollowing(!this.#isFollowing);
  }

  get #isFollowing() {
    return this.#follow.getAttribute("aria-pressed") === "true";
  }

  #setFollowing(follows) {
    this.#follow.setAttribute("aria-pressed", follows);
    const newest = this.#list.lastElementChild?.scan;
    if (follows && newest && newest !== this.#shown) this.#open(newest);
  }

  async #poll() {
    try {
      const { epoch, scans } = await service.fetchLive(this.#last);
      if (epoch === this.#epoch) this.#take(scans);
      else await this.#beginAnew(epoch);
    } catch {
      // The service is unavailable for a while, which the page reports: the scans are requested
      // again later.
    }
    setTimeout(() => this.#poll(), kPollMs);
  }

  #take(scans) {
    this.#add(scans);
    if (scans.length && this.#isFollowing) this.#open(scans.at(-1));
  }

  /** A restarted service numbers scans anew and does not know the listed ones. */
  async #beginAnew(epoch) {
    this.#last = 0;
    const { scans } = await service.fetchLive(0);
    this.#epoch = epoch;
    this.#list.replaceChildren();
    this.#take(scans);
  }

  #add(scans) {
    const { scrollLeft, scrollWidth, clientWidth } = this.#list;
    const isAtEnd = scrollLeft + clientWidth >= scrollWidth - 8;
    this.#list.append(...scans.map((scan) => this.#row(scan)));
    while (this.#list.childElementCount > kMost) this.#list.firstElementChild.remove();
    this.#last = scans.at(-1)?.number ?? this.#last;
    if (isAtEnd) this.#list.scrollLeft = this.#list.scrollWidth;
  }

  #row(scan) {
    const told = scan.error ?? `${scan.detections} found, ${secondsWords(scan.seconds)}`;
    const came = new Date(1000 * scan.time).toLocaleTimeString();
    const button = element(
      "button",
      {
        type: "button",
        className: scan.error ? "failed" : "",
        title: `${scan.name}, ${came}: ${told}`,
        "aria-label": `${scan.name}: ${told}`,
        onclick: () => {
          this.#setFollowing(false);
          this.#open(scan);
        },
      },
      element("span", { className: "count" }, scan.error ? "!" : String(scan.detections)),
      element("span", { className: "dim" }, scan.error ? "error" : secondsWords(scan.seconds)),
    );
    const item = element("li", {}, button);
    item.scan = scan;
    return item;
  }

  async #open(scan) {
    this.#shown = scan;
    for (const item of this.#list.children) {
      const button = item.firstElementChild;
      if (item.scan === scan) button.setAttribute("aria-current", "true");
      else button.removeAttribute("aria-current");
    }
    byId("live-now").textContent = scan.error
      ? `${scan.name}: ${scan.error}`
      : `${scan.name}: ${numbered(scan.detections, "model", "models")} found`;
    if (scan.error) return this.onFailed(scanOfExample(scan), scan.error);
    try {
      const answer = await service.fetchAnswer(scan.answer);
      if (this.#shown === scan) this.onOpen(scanOfExample(scan), answer);
    } catch (error) {
      if (this.#shown === scan) this.onFailed(scanOfExample(scan), error.message);
    }
  }
}

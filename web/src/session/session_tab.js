import { byId } from "../dom.js";
import { scanOfExample } from "../scan.js";
import { fetchSession, scanUrl } from "./client.js";
import { Marks } from "./marks.js";
import { measuresOf } from "./measures.js";
import { SessionPanel } from "./panel.js";
import { Session } from "./session.js";

const kMerged = " It was marked elsewhere meanwhile: both are kept, and yours where they differ.";

/** The page's part of the session kept by the service, if there is one. */
export class SessionTab {
  #session = null;
  #panel = null;
  // The kept answer that is shown: { scan, run, answer, detections }.
  #kept = null;
  #marks = new Marks((marks) => this.#mark(marks));
  #marking = Promise.resolve();

  /**
   * page  { open(scan, answer or null), parameters(scan), adopt(scan, camera),
   *   fault(scan): { message }, or null, select(id),
   *   selected(), meshes, library() }
   */
  constructor(page) {
    this.page = page;
  }

  async start() {
    const index = await fetchSession();
    if (!index.kept) return;
    this.#session = new Session(index);
    this.#panel = new SessionPanel(this.#session, {
      open: (scan, run, answer) => this.#open(scan, run, answer),
      parameters: this.page.parameters,
      modelOf: (names) => this.#modelOf(names),
    });
    byId("tab-session").hidden = false;
  }

  get isKept() {
    return this.#session !== null;
  }

  /** Adds dropped scans. scans, camera: see readScans */
  add(scans, camera) {
    this.page.adopt(scans[0], camera);
    const fault = this.page.fault(scans[0]);
    if (fault) return this.#panel.say(fault.message);
    return this.#panel.add(scans);
  }

  focus() {
    this.#panel.focus();
  }

  /** A different answer follows: it is not a kept one unless show() says so. */
  leave() {
    this.#marks.expect(false);
  }

  /** The answer to be shown next may belong to the session. */
  enter(answer) {
    this.#marks.expect(this.#kept?.answer === answer);
  }

  buttonsFor(id) {
    return this.#marks.buttonsFor(id);
  }

  /** Shows the marks of an answer once its rows exist, if it belongs to the session. */
  async show(answer = this.#kept.answer) {
    if (this.#kept?.answer !== answer) return;
    const { scan, detections } = this.#kept;
    const modelOf = await this.#modelOf(detections.map(({ model }) => model));
    if (this.#kept?.detections !== detections) return;
    const isTold = this.#session.scan(scan).truth !== null;
    this.#marks.show(this.#session.verdicts(scan, detections, modelOf), isTold);
  }

  /**
   * The action of the mark keys: none while no kept answer is shown. Then selects the next
   * detection.
   */
  mark(right) {
    const id = this.page.selected();
    this.#marks.mark(id, right);
    const next = this.#marks.openAfter(id);
    if (next) this.page.select(next);
  }
  markAll() {
    this.#marks.markAll();
  }

  #modelOf(names) {
    const { meshes, library } = this.page;
    return measuresOf(names, { meshes, library: library(), unit: this.#session.unit });
  }

  #open(scan, run, answer) {
    const { name, query } = scan;
    this.#kept = answer && { scan: name, run, answer, detections: answer.scenes[0].detections };
    return this.page.open(scanOfExample({ name, query, url: scanUrl(name) }), answer);
  }

  /** Makes changes one after the other, as each starts from the truth left by the last. */
  #mark(marks) {
    const kept = this.#kept;
    this.#marking = this.#marking.then(async () => {
      const { scan, run, detections } = kept;
      const truth = this.#session.scan(scan).truth ?? [];
      const names = [...detections, ...truth].map(({ model }) => model);
      let isStale;
      try {
        isStale = await this.#session.mark(run, scan, marks, await this.#modelOf(names));
      } catch (error) {
        byId("verdicts-note").textContent = error.message;
        return;
      }
      this.#panel.show();
      if (this.#kept !== kept) return;
      const { detections: marked } = (await this.#session.answer(run, scan)).scenes[0];
      kept.detections.splice(0, kept.detections.length, ...marked);
      await this.show();
      if (isStale) byId("verdicts-note").textContent += kMerged;
    });
  }
}

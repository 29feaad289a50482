import { compareByTruth, compareRuns } from "../compare.js";
import { byId, element, moveByArrows } from "../dom.js";
import { fetchBytes, fetchPoints, recognize } from "../service.js";
import { numbered, secondsWords } from "../words.js";
import { kArchive, scanUrl } from "./client.js";
import { drawThumbnail } from "./thumbnail.js";

const kThumbnail = { width: 96, height: 72, "aria-hidden": "true" };
const kThumbnailPoints = 40_000;

function bytesWords(bytes) {
  const kMega = 1 << 20;
  if (bytes >= 1024 * kMega) return `${(bytes / kMega / 1024).toFixed(1)} GB`;
  return `${bytes < 10 * kMega ? (bytes / kMega).toFixed(1) : Math.round(bytes / kMega)} MB`;
}

/**
 * The differences between the settings of two runs, from the queries of their answers for one scan.
 */
function differenceWords(first, second, queries) {
  if (!queries?.every((query) => query !== undefined)) return "";
  const [a, b] = queries.map((query) => new URLSearchParams(query));
  const words = [...new Set([...a.keys(), ...b.keys()])]
    .filter((name) => a.get(name) !== b.get(name))
    .map((name) => `${name} ${a.get(name) ?? "as usual"} in ${first}, ${b.get(name) ?? "as usual"} in ${second}`);
  return words.length ? `Set differently: ${words.join("; ")}.` : "Both were asked with the same settings.";
}

/** Which of two runs finds more right poses, and whether the difference may be chance. */
function verdictWords(first, second, { scans, right, onlyA, onlyB, chance, ...all }) {
  if (!scans)
    return "Mark what is right in the scans, and read here which run finds more of it, and how sure that is.";
  const counts = (run, found, others) =>
    `${run} finds ${found}${others ? ` and ${others} that ${others === 1 ? "is" : "are"} not` : ""}`;
  const found =
    `Of ${numbered(right, "part", "parts")} marked right in ${numbered(scans, "scan", "scans")}, ` +
    `${counts(first, all.foundA, all.wrongA)}, ${counts(second, all.foundB, all.wrongB)}.`;
  if (!onlyA && !onlyB) return `${found} Both find the same of them.`;
  const p = chance < 0.001 ? "below 0.001" : `${Number(chance.toPrecision(2))}`;
  const sure = chance < 0.05 ? "that is more than chance" : "that may be chance";
  return `${found} Only ${first} finds ${onlyA}, only ${second} ${onlyB}: ${sure} (McNemar’s exact test, p ${p}).`;
}

function truthWords(truth) {
  if (truth === null) return "not marked";
  return truth.length ? `${truth.length} right` : "nothing right";
}

/** The session tab: its scans, the runs over all of them, and a comparison of two runs. */
export class SessionPanel {
  #session;
  #list = byId("session-scans");
  // By the name of a scan: { item, button, facts, found }.
  #rows = new Map();
  #wanted = new IntersectionObserver((entries) => this.#draw(entries));
  #drawing = Promise.resolve();
  #running = null;
  #shown = null;

  /**
   * session  a Session
   * page     { open(scan, run, answer or null), parameters(scan): of a recognition, modelOf(names):
   *          promises the properties of these models for comparing poses, by name }
   */
  constructor(session, page) {
    this.#session = session;
    this.page = page;
    byId("session-archive").href = kArchive;
    byId("run-all").onclick = () => this.runAll();
    byId("run-stop").onclick = () => this.#running?.abort();
    byId("run-shown").onchange = () => this.show();
    byId("run-delete").onclick = () => {
      if (!confirm(`Delete run ${this.run}, all of its answers and marks?`)) return;
      this.#change(() => session.removeRun(this.run));
    };
    for (const id of ["run-a", "run-b"]) byId(id).onchange = () => this.#compare();
    moveByArrows(this.#list, "button.scan");
    this.show();
  }

  /** The run whose answers are opened; empty: none. */
  get run() {
    return byId("run-shown").value;
  }

  /** Updates the whole panel. */
  show() {
    const session = this.#session;
    const { used, allowed } = session.bytes;
    byId("session-facts").textContent =
      `${numbered(session.scans.length, "scan", "scans")}, ${bytesWords(used)} of ` +
      `${bytesWords(allowed)}`;
    byId("session-faults").replaceChildren(
      ...session.faults.map(({ file, reason }) => element("li", {}, `${file}: ${reason}`)),
    );
    byId("session-empty").hidden = session.scans.length > 0;
    byId("run-all").disabled = !session.scans.length || Boolean(this.#running);
    byId("run-all").textContent = `Run all as ${session.nextRun()}`;
    byId("run-all").title = "Recognize every scan with the settings of the tab Result";
    byId("session-archive").hidden = !session.scans.length;
    this.#offerRuns();
    this.#listScans();
    this.#compare();
  }

  mark(name) {
    this.#shown = name;
    for (const [other, { button }] of this.#rows) {
      if (other === name) button.setAttribute("aria-current", "true");
      else button.removeAttribute("aria-current");
    }
  }

  say(message) {
    byId("session-problem").textContent = message;
  }

  focus() {
    (this.#list.querySelector("button.scan[tabindex='0']") ?? byId("run-all")).focus();
  }

  /** Adds scans to the session, one after the other. */
  add(scans) {
    const told = (count) => {
      this.#progress(count, scans.length, `${count} of ${scans.length} kept`);
      this.show();
    };
    return this.#change(async () => {
      this.#progress(0, scans.length, `Keeping ${numbered(scans.length, "scan", "scans")} …`);
      await this.#session.add(scans, this.page.parameters, told);
    });
  }

  /** Recognizes each scan with the current settings, and keeps the answers as a new run. */
  async runAll() {
    if (this.#running || !this.#session.scans.length) return;
    const session = this.#session;
    const run = session.nextRun();
    const asking = new AbortController();
    this.#running = asking;
    byId("run-stop").hidden = false;
    byId("run-all").disabled = true;
    await this.#change(async () => {
      const scans = [...session.scans];
      for (const [k, scan] of scans.entries()) {
        this.#progress(k, scans.length, `Run ${run}: ${scan.name}, ${k + 1} of ${scans.length}`);
        await this.#recognize(run, scan, asking.signal);
        this.show();
        if (k === 0) byId("run-shown").value = run;
      }
      this.#compareLast();
    });
    this.#running = null;
    byId("run-stop").hidden = true;
    this.show();
  }

  async #recognize(run, scan, signal) {
    const body = await fetchBytes(scanUrl(scan.name), signal);
    const format = new URLSearchParams(scan.query).get("format");
    const parameters = this.#session.parametersFor(scan, this.page.parameters({ format }));
    try {
      const { answer } = await recognize({ body }, parameters, signal);
      answer.query = parameters.toString();
      await this.#session.keepAnswer(run, scan.name, answer, signal);
    } catch (error) {
      if (error.name !== "AbortError") error.message = `${scan.name}: ${error.message}`;
      throw error;
    }
  }

  /** Changes the session; an error is shown. */
  async #change(act) {
    this.say("");
    try {
      await act();
    } catch (error) {
      if (error.name !== "AbortError") this.say(error.message);
    } finally {
      byId("run-progress").hidden = true;
      this.show();
    }
  }

  #progress(done, total, words) {
    byId("run-progress").hidden = false;
    Object.assign(byId("run-progress").querySelector("progress"), { max: total, value: done });
    byId("run-words").textContent = words;
  }

  #offerRuns() {
    const { runs } = this.#session;
    byId("run-box").hidden = !runs.length;
    const before = byId("run-shown").value;
    for (const id of ["run-shown", "run-a", "run-b"]) {
      const select = byId(id);
      const chosen = select.value;
      select.replaceChildren(...runs.map((run) => element("option", { value: run }, run)));
      if (runs.includes(chosen)) select.value = chosen;
    }
    if (!runs.includes(before)) byId("run-shown").value = runs.at(-1) ?? "";
    byId("compare-section").hidden = runs.length < 2;
    if (byId("run-a").value === byId("run-b").value) this.#compareLast();
  }

  #compareLast() {
    [byId("run-a").value, byId("run-b").value] = this.#session.runs.slice(-2);
  }

  #listScans() {
    const { scans } = this.#session;
    for (const [name, { item }] of this.#rows) {
      if (this.#session.scan(name)) continue;
      item.remove();
      this.#rows.delete(name);
    }
    for (const scan of scans) {
      if (!this.#rows.has(scan.name)) this.#addRow(scan);
      const { facts, found } = this.#rows.get(scan.name);
      facts.textContent = `${bytesWords(scan.bytes)}, ${truthWords(scan.truth)}`;
      found.replaceChildren(
        ...this.#session.runs.flatMap((run) => {
          const summary = this.#session.summary(run, scan.name);
          if (!summary) return [];
          const words = `${run} ${summary.found}`;
          const label = `run ${run}: ${summary.found} found`;
          const isShown = run === this.run;
          return element("span", { className: isShown ? "run shown" : "run", title: label }, words);
        }),
      );
    }
    this.#list.append(...scans.map(({ name }) => this.#rows.get(name).item));
    this.mark(this.#shown);
  }

  #addRow({ name }) {
    const picture = element("canvas", kThumbnail);
    const facts = element("span", { className: "dim" });
    const found = element("span", { className: "runs" });
    const button = element(
      "button",
      { type: "button", className: "scan", onclick: () => this.#open(name, this.run) },
      picture,
      element("span", { className: "name" }, name),
      facts,
      found,
    );
    const remove = element(
      "button",
      {
        type: "button",
        className: "plain",
        "aria-label": `Remove ${name}`,
        onclick: () => this.#remove(name),
      },
      "Remove",
    );
    picture.dataset.scan = name;
    this.#wanted.observe(picture);
    this.#rows.set(name, { item: element("li", {}, button, remove), button, facts, found });
  }

  #remove(name) {
    if (!confirm(`Remove ${name}, with its answers in all runs and its marks?`)) return;
    this.#change(() => this.#session.removeScan(name));
  }

  async #open(name, run) {
    this.say("");
    try {
      const kept = run && this.#session.summary(run, name);
      const answer = kept ? await this.#session.answer(run, name) : null;
      this.mark(name);
      await this.page.open(this.#session.scan(name), run, answer);
    } catch (error) {
      this.say(error.message);
    }
  }

  /** Draws thumbnails of scans as they become visible, one after the other. */
  #draw(entries) {
    for (const { isIntersecting, target } of entries) {
      if (!isIntersecting) continue;
      this.#wanted.unobserve(target);
      this.#drawing = this.#drawing.then(() => this.#drawOne(target)).catch(() => {});
    }
  }

  async #drawOne(canvas) {
    const scan = this.#session.scan(canvas.dataset.scan);
    if (!scan) return;
    const body = await fetchBytes(scanUrl(scan.name));
    const parameters = new URLSearchParams(scan.query);
    parameters.set("max-points", kThumbnailPoints);
    const { positions, offset, viewpoint } = await fetchPoints({ body }, parameters);
    const from = (viewpoint ?? [0, 0, 0]).map((x, axis) => x - offset[axis]);
    const [r, g, b] = getComputedStyle(canvas).color.match(/[\d.]+/g).map(Number);
    drawThumbnail(canvas, positions, from, [r, g, b]);
  }

  /** Compares two runs on the scans that both have answers for. */
  async #compare() {
    const [first, second] = [byId("run-a").value, byId("run-b").value];
    if (byId("compare-section").hidden || !first || !second) return;
    const session = this.#session;
    const shared = session.scansOf(first).filter((name) => session.summary(second, name));
    try {
      const scans = await Promise.all(
        shared.map(async (name) => {
          const [a, b] = await Promise.all([
            session.answer(first, name),
            session.answer(second, name),
          ]);
          return {
            name,
            a: a.scenes[0].detections,
            b: b.scenes[0].detections,
            truth: session.scan(name).truth,
            queries: [a.query, b.query],
            secondsA: a.seconds?.work ?? null,
            secondsB: b.seconds?.work ?? null,
          };
        }),
      );
      const names = scans.flatMap(({ a, b, truth }) =>
        [...a, ...b, ...(truth ?? [])].map(({ model }) => model),
      );
      const modelOf = await this.page.modelOf(names);
      if (first !== byId("run-a").value || second !== byId("run-b").value) return;
      byId("compare-settings").textContent = differenceWords(first, second, scans[0]?.queries);
      this.#showComparison(first, second, compareRuns(scans, modelOf));
      byId("compare-verdict").textContent = verdictWords(first, second, compareByTruth(scans, modelOf));
    } catch (error) {
      this.say(error.message);
    }
  }

  #showComparison(first, second, { rows, total }) {
    const seconds = (value) => (value === null ? "–" : secondsWords(value));
    const cell = (text, className = "number") => element("td", { className }, `${text}`);
    const row = (head, { both, onlyA, onlyB, secondsA, secondsB }) =>
      element(
        "tr",
        {},
        element("th", { scope: "row" }, head),
        cell(both),
        cell(onlyA, onlyA ? "number lost" : "number"),
        cell(onlyB, onlyB ? "number gained" : "number"),
        cell(seconds(secondsA)),
        cell(seconds(secondsB)),
      );
    const ofRuns = (what) => [`${what} ${first}`, `${what} ${second}`];
    const heads = ["Scan", "both", ...ofRuns("only"), ...ofRuns("time")].map((text) =>
      element("th", { scope: "col" }, text),
    );
    byId("comparison").replaceChildren(
      element("thead", {}, element("tr", {}, heads)),
      element(
        "tbody",
        {},
        rows.map((one) =>
          row(
            element(
              "button",
              { type: "button", className: "plain", onclick: () => this.#open(one.name, second) },
              one.name,
            ),
            one,
          ),
        ),
      ),
      element("tfoot", {}, row(numbered(rows.length, "scan", "scans"), total)),
    );
  }
}

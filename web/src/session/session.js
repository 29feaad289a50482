import { matchDetections } from "../compare.js";
import { kImageParameters } from "../scan.js";
import * as client from "./client.js";

const kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZ";
const kReading = ["format", "unit", "camera", ...kImageParameters, "viewpoint"];

/** A valid and unused name: `left_2` after `left`. */
function freeName(file, taken) {
  const stem = file.replace(/(\.gz)?$/i, "").replace(/\.[^.]*$/, "");
  const plain =
    stem
      .replace(/[^A-Za-z0-9_-]+/g, "_")
      .replace(/^[^A-Za-z0-9]+/, "")
      .slice(0, 56) || "scan";
  let name = plain;
  for (let k = 2; taken.has(name); ++k) name = `${plain}_${k}`;
  return name;
}

/** Whether two lists contain the same detections, regardless of their marks. */
const hasSame = (some, others) => {
  const posed = (all) => JSON.stringify(all.map(({ model, T_scene_model }) => [model, T_scene_model]));
  return posed(some) === posed(others);
};

/** The scans kept by the service, the detections of runs in them, and which of these are right. */
export class Session {
  #index;
  // { answer, version }, by run and scan.
  #answers = new Map();

  constructor(index) {
    this.#index = index;
  }

  get unit() {
    return this.#index.unit;
  }
  get bytes() {
    return this.#index.bytes;
  }
  get faults() {
    return this.#index.faults;
  }
  get scans() {
    return this.#index.scans;
  }
  get runs() {
    return this.#index.runs.map(({ name }) => name);
  }

  scan(name) {
    return this.scans.find((scan) => scan.name === name);
  }

  /** The summary of a run's answer for a scan: { found, seconds }; undefined: no answer. */
  summary(run, scan) {
    const answers = this.#index.runs.find(({ name }) => name === run)?.answers;
    return answers?.find((answer) => answer.scan === scan);
  }

  /** The names of the scans with an answer of this run. */
  scansOf(run) {
    return this.#index.runs.find(({ name }) => name === run)?.answers.map(({ scan }) => scan) ?? [];
  }

  async refresh() {
    this.#index = await client.fetchSession();
  }

  /**
   * Adds files to the session.
   *
   * parametersOf(format)  returns how a scan of this format is read
   * onDone(count)         is called after each
   */
  async add(scans, parametersOf, onDone) {
    try {
      for (const [k, scan] of scans.entries()) {
        const name = freeName(scan.name, new Set(this.scans.map((other) => other.name)));
        const all = parametersOf(scan);
        const parameters = new URLSearchParams(
          kReading.filter((key) => all.has(key)).map((key) => [key, all.get(key)]),
        );
        try {
          await client.putScan(name, parameters, scan.body);
        } catch (error) {
          error.message = `${scan.name}: ${error.message}`;
          throw error;
        }
        await this.refresh();
        onDone(k + 1);
      }
    } finally {
      await this.refresh();
    }
  }

  async removeScan(name) {
    await client.deleteScan(name);
    for (const run of this.runs) this.#answers.delete(`${run}/${name}`);
    await this.refresh();
  }

  async removeRun(run) {
    await client.deleteRun(run);
    for (const scan of this.scans) this.#answers.delete(`${run}/${scan.name}`);
    await this.refresh();
  }

  async answer(run, scan) {
    return (await this.#kept(run, scan)).answer;
  }

  async #kept(run, scan) {
    const key = `${run}/${scan}`;
    if (!this.#answers.has(key)) this.#answers.set(key, await client.fetchAnswer(run, scan));
    return this.#answers.get(key);
  }

  async keepAnswer(run, scan, answer, signal) {
    const { version } = await client.putAnswer(run, scan, answer, { signal });
    this.#answers.set(`${run}/${scan}`, { answer, version });
    await this.refresh();
  }

  /** The name of the next run: A, B, ... */
  nextRun() {
    const taken = new Set(this.runs);
    const letter = [...kLetters].find((name) => !taken.has(name));
    if (letter) return letter;
    let k = kLetters.length + 1;
    while (taken.has(`R${k}`)) ++k;
    return `R${k}`;
  }

  /** Parameters to recognize a scan with these settings, read as stored in the session. */
  parametersFor(scan, settings) {
    const parameters = new URLSearchParams(settings);
    const query = new URLSearchParams(scan.query);
    for (const key of kReading) {
      parameters.delete(key);
      if (query.has(key)) parameters.set(key, query.get(key));
    }
    return parameters;
  }

  /**
   * Whether each detection of an answer is right, by its mark or else by the scan's truth: true
   * (right), false (wrong) or null.
   */
  verdicts(scan, detections, modelOf) {
    const truth = this.scan(scan).truth ?? [];
    const matched = new Set(matchDetections(detections, truth, modelOf).map(([i]) => i));
    return detections.map(({ right }, i) => right ?? (matched.has(i) ? true : null));
  }

  /**
   * Marks detections of a kept answer, and saves the truth once all of them are marked. If another
   * user marked the scan meanwhile, these marks override those.
   *
   * marks  { index: true, false, or null for not marked }
   * Returns whether another user did. Errors: those of the service; the answer has changed.
   */
  async mark(run, scan, marks, modelOf) {
    const isStaleAnswer = await this.#markAnswer(run, scan, marks);
    // The truth may have changed as well.
    if (isStaleAnswer) await this.refresh();
    const isStaleTruth = await this.#tellTruth(run, scan, marks, modelOf);
    await this.refresh();
    return isStaleAnswer || isStaleTruth;
  }

  /** Adds marks to the current kept answer. Returns whether that had changed. */
  async #markAnswer(run, scan, marks) {
    const key = `${run}/${scan}`;
    const { detections: seen } = (await this.answer(run, scan)).scenes[0];
    for (let isStale = false; ; isStale = true) {
      const { answer, version } = await this.#kept(run, scan);
      const marked = structuredClone(answer);
      if (!hasSame(marked.scenes[0].detections, seen)) {
        throw new Error("This scan was run again meanwhile, and nothing is marked: open it anew.");
      }
      for (const [index, right] of Object.entries(marks)) {
        const detection = marked.scenes[0].detections[index];
        if (right === null) delete detection.right;
        else detection.right = right;
      }
      try {
        const put = await client.putAnswer(run, scan, marked, { version });
        this.#answers.set(key, { answer: marked, version: put.version });
        return isStale;
      } catch (error) {
        if (error.status !== 409 || !error.told.answer) throw error;
        this.#answers.set(key, { answer: error.told.answer, version: error.told.version });
      }
    }
  }

  /**
   * Saves the truth of a scan, once all detections of a kept answer are marked. The marks replace
   * the truth at the same positions. Returns whether the truth had changed since it was read.
   */
  async #tellTruth(run, scan, marks, modelOf) {
    const { detections } = (await this.answer(run, scan)).scenes[0];
    for (let isStale = false; ; isStale = true) {
      const { truth: old, version } = this.scan(scan);
      const verdicts = this.verdicts(scan, detections, modelOf);
      for (const [index, right] of Object.entries(marks)) verdicts[index] = right;
      if (!old && !verdicts.every((verdict) => verdict !== null)) return isStale;
      const places = new Set(matchDetections(old ?? [], detections, modelOf).map(([i]) => i));
      const truth = [
        ...(old ?? []).filter((_, i) => !places.has(i)),
        ...detections
          .filter((_, i) => verdicts[i])
          .map(({ model, T_scene_model }) => ({ model, T_scene_model })),
      ];
      try {
        await client.putTruth(scan, truth, version);
        return isStale;
      } catch (error) {
        if (error.status !== 409 || !error.told.scan) throw error;
        Object.assign(this.scan(scan), error.told.scan);
      }
    }
  }
}

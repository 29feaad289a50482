import { copiesOnClick } from "../copy.js";
import { byId, element } from "../dom.js";
import { downloadsText, withholdsText } from "../download.js";
import { numbered } from "../words.js";
import { conventionOptions } from "./convention_options.js";
import { frameText, readFrame, readGrasps } from "./frames.js";

const kNoTable = "There is no table while the setup is refused: see above.";

/** The robot setup, and a table of all found poses. */
export class RobotPanel {
  #robot;
  #onChange;
  #form = byId("robot");
  #models = null;

  /** onChange  called when the form of the poses changes */
  constructor(robot, onChange) {
    this.#robot = robot;
    this.#onChange = onChange;
    const { convention, frame, "frame-name": frameName } = this.#form.elements;
    convention.onchange = () => this.#change({ convention: convention.value });
    frame.value = robot.setup.frame;
    frame.onchange = () => this.#takeFrame();
    frameName.value = robot.setup.frameName;
    frameName.onchange = () => this.#change({ frameName: frameName.value.trim() });
    byId("choose-frame").onclick = () => byId("frame-file").click();
    byId("frame-file").onchange = async ({ target }) => {
      frame.value = await target.files[0].text();
      // The same file can then be chosen again.
      target.value = "";
      this.#takeFrame();
    };
    byId("choose-grasps").onclick = () => byId("grasps-file").click();
    byId("grasps-file").onchange = ({ target }) => this.#takeGrasps(target);
    byId("forget-grasps").onclick = () => this.#change({ grasps: {}, graspsFault: "" });
    this.#form.onsubmit = (event) => event.preventDefault();
  }

  /** Offers the conventions, once their words are fetched. */
  start() {
    const options = conventionOptions();
    this.#robot.takeConventions(options.map(({ value }) => value));
    this.#form.elements.convention.append(...options);
    this.refresh();
  }

  /**
   * Offers the table of an answer: see Robot.answer; null: none.
   *
   * models  of the library
   */
  show(answer, models = null) {
    this.#robot.answer = answer;
    this.#models = models;
    byId("robot-box").hidden = !answer?.detections.length;
    this.refresh();
  }

  /** Shows the current setup, and offers the table once the service has made it. */
  async refresh() {
    const { convention, grasps, graspsFault } = this.#robot.setup;
    const { frameFault } = this.#robot;
    this.#form.elements.convention.value = convention;
    this.#form.elements.frame.setAttribute("aria-invalid", frameFault !== "");
    byId("frame-note").textContent = frameFault;
    this.#tellGrasps(grasps, graspsFault);
    if (!this.#robot.answer?.detections.length) return;
    byId("copy-robot").disabled = true;
    withholdsText(byId("download-robot"));
    this.#robot.retry();
    const asked = this.#robot.poses();
    const { refusal, doubt, table } = await asked;
    if (!this.#robot.isCurrent(asked)) return;
    byId("robot-now").textContent = refusal ? "no poses: see why" : `in frame ${this.#robot.frameName}`;
    this.#ask(doubt);
    byId("robot-refusal").textContent = frameFault || graspsFault ? kNoTable : refusal;
    byId("copy-robot").textContent = "Copy table";
    byId("copy-robot").disabled = refusal !== "";
    if (refusal) return;
    copiesOnClick(byId("copy-robot"), table);
    const end = `${this.#robot.frameName}.${convention}.csv`;
    downloadsText(byId("download-robot"), table, "text/csv", this.#robot.answer.scene, end);
  }

  #change(some) {
    this.#robot.change(some);
    this.refresh();
    this.#onChange();
  }

  /** Applies the field's content; an invalid frame is refused, and stays to be corrected. */
  #takeFrame() {
    const field = this.#form.elements.frame;
    try {
      if (field.value.trim()) field.value = frameText(readFrame(field.value));
    } catch {
      // The robot reports the reason.
    }
    this.#change({ frame: field.value });
  }

  async #takeGrasps(chooser) {
    const [file] = chooser.files;
    const text = await file.text();
    // The same file can then be chosen again.
    chooser.value = "";
    try {
      this.#change({ grasps: readGrasps(text), graspsFault: "" });
    } catch (error) {
      this.#change({ graspsFault: `The grasps are not taken: ${file.name}: ${error.message}.` });
    }
  }

  /** Asks about lengths that probably have another unit, if there are any. */
  #ask(doubt) {
    const settle = (act) => () => {
      act();
      this.#form.elements.frame.value = this.#robot.setup.frame;
      this.#change({});
    };
    const button = (label, act) =>
      element("button", { type: "button", onclick: settle(act) }, label);
    byId("robot-doubt").replaceChildren(
      ...(doubt
        ? [
            button(`They are in ${doubt.likelier}: convert them to ${doubt.unit}`, doubt.convert),
            button(`They are in ${doubt.unit}, as they are`, doubt.accept),
          ]
        : []),
    );
  }

  #tellGrasps(grasps, fault) {
    const models = Object.keys(grasps);
    const count = Object.values(grasps).reduce((sum, own) => sum + Object.keys(own).length, 0);
    const known = this.#models?.map(({ name }) => name);
    const unknown = models.filter((model) => !known?.includes(model));
    byId("forget-grasps").hidden = !count && !fault;
    byId("grasps-note").className = fault ? "problem" : "";
    byId("grasps-note").textContent = fault ||
      (count
        ? `${numbered(count, "grasp", "grasps")} of ${numbered(models.length, "model", "models")}` +
          (known && unknown.length ? `; not in the library: ${unknown.join(", ")}` : "")
        : "None: poses are those of the models' own frames.");
  }
}

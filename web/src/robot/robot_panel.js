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
  #answer = null; // { scene: its name, detections, about: see Robot }

  /** onChange  called when the form of the poses changes */
  constructor(robot, onChange) {
    this.#robot = robot;
    this.#onChange = onChange;
    const { convention, frame, "frame-name": frameName } = this.#form.elements;
    convention.append(...conventionOptions());
    convention.onchange = () => this.#change({ convention: convention.value });
    frame.value = robot.setup.frame;
    frame.onchange = () => this.#takeFrame();
    frameName.value = robot.setup.frameName;
    frameName.onchange = () => this.#change({ frameName: frameName.value.trim() });
    byId("choose-frame").onclick = () => byId("frame-file").click();
    byId("frame-file").onchange = async ({ target }) => {
      frame.value = await target.files[0].text();
      target.value = ""; // so that the same file can be chosen again
      this.#takeFrame();
    };
    byId("choose-grasps").onclick = () => byId("grasps-file").click();
    byId("grasps-file").onchange = ({ target }) => this.#takeGrasps(target);
    byId("forget-grasps").onclick = () => this.#change({ grasps: {}, graspsFault: "" });
    this.#form.onsubmit = (event) => event.preventDefault();
    this.refresh();
  }

  /**
   * Offers the table of an answer, { scene: its name, detections, about: see Robot }; null: none.
   */
  show(answer) {
    this.#answer = answer;
    byId("robot-box").hidden = !answer?.detections.length;
    this.refresh();
  }

  /** Shows the current setup. */
  refresh() {
    const { convention, grasps, graspsFault } = this.#robot.setup;
    const { frameFault } = this.#robot;
    this.#form.elements.convention.value = convention;
    this.#form.elements.frame.setAttribute("aria-invalid", frameFault !== "");
    byId("frame-note").textContent = frameFault;
    this.#tellGrasps(grasps, graspsFault);
    if (!this.#answer?.detections.length) return;
    const { scene, detections, about } = this.#answer;
    const refusal = this.#robot.refusal(about);
    byId("robot-now").textContent = refusal ? "no poses: see why" : `in frame ${this.#robot.frameName}`;
    this.#ask(frameFault || graspsFault ? null : this.#robot.doubt(about));
    byId("robot-refusal").textContent = frameFault || graspsFault ? kNoTable : refusal;
    byId("copy-robot").textContent = "Copy table";
    byId("copy-robot").disabled = refusal !== "";
    if (refusal) return withholdsText(byId("download-robot"));
    const table = this.#robot.table(scene, detections, about);
    copiesOnClick(byId("copy-robot"), table);
    const end = `${this.#robot.frameName}.${convention}.csv`;
    return downloadsText(byId("download-robot"), table, "text/csv", scene, end);
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
    chooser.value = ""; // so that the same file can be chosen again
    try {
      this.#change({ grasps: readGrasps(text), graspsFault: "" });
    } catch (error) {
      this.#change({ graspsFault: `The grasps are not taken: ${file.name}: ${error.message}.` });
    }
  }

  /** Asks about lengths that probably have another unit; null: there are none. */
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
    const known = this.#answer?.about.models.map(({ name }) => name);
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

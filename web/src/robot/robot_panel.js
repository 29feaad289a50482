import { copiesOnClick } from "../copy.js";
import { byId } from "../dom.js";
import { downloadsText } from "../download.js";
import { numbered } from "../words.js";
import { conventionOptions } from "./convention_options.js";
import { readFrame, readGrasps } from "./frames.js";

const frameText = (rows) => (rows ? rows.map((row) => row.join(" ")).join("\n") : "");

/** What the poses found are told to, and all of them as its table. */
export class RobotPanel {
  #robot;
  #onChange;
  #form = byId("robot");
  #answer = null; // { scene: its name, detections, units }

  /** onChange  called when poses are told otherwise */
  constructor(robot, onChange) {
    this.#robot = robot;
    this.#onChange = onChange;
    const { convention, frame } = this.#form.elements;
    convention.append(...conventionOptions());
    convention.onchange = () => this.#change({ convention: convention.value });
    frame.value = frameText(robot.setup.frame);
    frame.onchange = () => this.#takeFrame(frame);
    byId("choose-frame").onclick = () => byId("frame-file").click();
    byId("frame-file").onchange = async ({ target }) => {
      frame.value = await target.files[0].text();
      target.value = ""; // so that the same file can be chosen again
      this.#takeFrame(frame);
    };
    byId("choose-grasps").onclick = () => byId("grasps-file").click();
    byId("grasps-file").onchange = ({ target }) => this.#takeGrasps(target);
    byId("forget-grasps").onclick = () => this.#change({ grasps: {} });
    this.#form.onsubmit = (event) => event.preventDefault();
    this.refresh();
  }

  /** Offer the table of an answer; null: of none. units  { scan, library } */
  show(answer) {
    this.#answer = answer;
    byId("robot-box").hidden = !answer?.detections.length;
    this.refresh();
  }

  /** Show the setup as it is. */
  refresh() {
    const { convention, grasps } = this.#robot.setup;
    this.#form.elements.convention.value = convention;
    this.#tellGrasps(grasps);
    if (!this.#answer?.detections.length) return;
    const { scene, detections, units } = this.#answer;
    const table = this.#robot.table(scene, detections, units);
    byId("copy-robot").textContent = "Copy table";
    copiesOnClick(byId("copy-robot"), table);
    downloadsText(byId("download-robot"), table, "text/csv", scene, `${convention}.csv`);
  }

  #change(some) {
    this.#robot.change(some);
    this.refresh();
    this.#onChange();
  }

  #takeFrame(field) {
    let fault = "";
    try {
      this.#change({ frame: field.value.trim() ? readFrame(field.value) : null });
      field.value = frameText(this.#robot.setup.frame);
    } catch (error) {
      fault = `The calibration is not taken: ${error.message}.`;
    }
    field.setAttribute("aria-invalid", fault !== "");
    byId("frame-note").textContent = fault;
  }

  async #takeGrasps(chooser) {
    const [file] = chooser.files;
    try {
      this.#change({ grasps: readGrasps(await file.text()) });
    } catch (error) {
      byId("grasps-note").textContent = `${file.name}: ${error.message}.`;
    }
    chooser.value = "";
  }

  #tellGrasps(grasps) {
    const models = Object.keys(grasps);
    const count = Object.values(grasps).reduce((sum, own) => sum + Object.keys(own).length, 0);
    const unknown = models.filter((model) => !this.#answer?.models.includes(model));
    byId("forget-grasps").hidden = !count;
    byId("grasps-note").textContent = count
      ? `${numbered(count, "grasp", "grasps")} of ${numbered(models.length, "model", "models")}` +
        (this.#answer && unknown.length ? `; not in the library: ${unknown.join(", ")}` : "")
      : "None: poses are those of the models' own frames.";
  }
}

import { keep, recall } from "../storage.js";
import { unitScale } from "../units.js";
import { lengthWords } from "../words.js";
import { kConventions, robotPose } from "./conventions.js";
import {
  checkedName,
  frameText,
  kSceneFrame,
  likelierGraspUnit,
  likelierUnit,
  product,
  readFrame,
  readGrasps,
  scaled,
} from "./frames.js";

const kRemembered = "trivet.robot";
const kDigits = 7; // of a table, as of `trivet recognize --robot-csv`
const kDefaults = {
  convention: "quaternion",
  frame: "",
  frameName: "robot",
  frameUnit: "",
  grasps: {},
  graspsFault: "",
  graspsUnit: "",
};

/** The stored setup, as far as it is readable; a frame is stored as typed. */
function remembered() {
  try {
    const { frame, grasps, ...others } = JSON.parse(recall(kRemembered));
    const kept = { ...kDefaults, ...others, grasps: readGrasps(JSON.stringify(grasps)) };
    if (!(kept.convention in kConventions)) kept.convention = kDefaults.convention;
    return { ...kept, frame: typeof frame === "string" ? frame : frameText(frame) };
  } catch {
    return kDefaults;
  }
}

const rounded = (value) => Number(value.toPrecision(kDigits));
const csvField = (value) => (/[",\n]/.test(value) ? `"${value.replaceAll('"', '""')}"` : `${value}`);

/**
 * The robot for which poses are shown: the convention of its controller, its frame, its grasps.
 *
 * A refused or doubtful input is part of the setup. No pose is shown meanwhile, since it could only
 * be in a frame that the user has given up. `about` describes the subject of the poses: { scan,
 * library: units, models: [{ name, diameter }] }.
 */
export class Robot {
  #setup = remembered();
  #frame = null; // T_robot_scene in the scan's unit; null: none is given, or it is refused
  #fault = "";

  constructor() {
    this.#read();
  }

  /**
   * { convention; frame: its text, "" for none; frameName; grasps: frames in the library's unit, by
   * model and name; graspsFault: why the last file of them was refused, or "" }, and frameUnit,
   * graspsUnit: the unit for which the user confirmed unlikely lengths, or ""
   */
  get setup() {
    return this.#setup;
  }

  /** The name of the frame of the poses. */
  get frameName() {
    return this.#setup.frame.trim() ? this.#setup.frameName : kSceneFrame;
  }

  /** Why the frame is refused, in a sentence; otherwise "". */
  get frameFault() {
    return this.#fault;
  }

  /** Changes part of the setup; the browser stores it. */
  change(some) {
    const asked = { ...("frame" in some && { frameUnit: "" }), ...("grasps" in some && { graspsUnit: "" }) };
    this.#setup = { ...this.#setup, ...asked, ...some };
    this.#read();
    keep(kRemembered, JSON.stringify(this.#setup));
  }

  #read() {
    const { frame, frameName } = this.#setup;
    this.#frame = null;
    this.#fault = "";
    if (!frame.trim()) return;
    try {
      checkedName(frameName);
      this.#frame = readFrame(frame);
    } catch (error) {
      this.#fault = `The calibration is not taken: ${error.message}.`;
    }
  }

  /**
   * Lengths that probably have another unit, to be confirmed: { words, unit: as read, likelier: the
   * other, accept(), convert() }, or null.
   */
  doubt(about) {
    const { frameUnit, grasps, graspsUnit } = this.#setup;
    const frameIn = this.#frame && frameUnit !== about.scan && likelierUnit(this.#frame, about.scan);
    if (frameIn) {
      const length = Math.hypot(...this.#frame.slice(0, 3).map((row) => row[3]));
      const convert = () =>
        this.change({ frame: frameText(scaled(this.#frame, unitScale(frameIn, about.scan))) });
      return {
        words:
          `The calibration moves by ${lengthWords(length, about.scan)}, if it is in ${about.scan} like the ` +
          `scan: its lengths look like ${frameIn}.`,
        unit: about.scan,
        likelier: frameIn,
        accept: () => this.change({ frameUnit: about.scan }),
        convert,
      };
    }
    const found = graspsUnit !== about.library && likelierGraspUnit(grasps, about);
    if (!found) return null;
    const { model, length, unit } = found;
    const scale = unitScale(unit, about.library);
    return {
      words:
        `Grasps of ${model} are up to ${lengthWords(length, about.library)} from its origin, if they are ` +
        `in ${about.library} like the library: their lengths look like ${unit}.`,
      unit: about.library,
      likelier: unit,
      accept: () => this.change({ graspsUnit: about.library }),
      convert: () => {
        const converted = ([name, own]) => [
          name,
          Object.fromEntries(Object.entries(own).map(([grasp, rows]) => [grasp, scaled(rows, scale)])),
        ];
        this.change({ grasps: Object.fromEntries(Object.entries(grasps).map(converted)) });
      },
    };
  }

  /** Why no pose is shown, in a sentence; "" when poses are. */
  refusal(about) {
    return this.#fault || this.#setup.graspsFault || (this.doubt(about)?.words ?? "");
  }

  /**
   * The robot poses of a detection: [{ grasp, numbers: [{ name, value, unit }] }], one for each
   * grasp of its model, or one without a name for the model frame.
   *
   * Errors: the setup is refused, or needs confirmation.
   */
  poses({ model, T_scene_model }, about) {
    const refusal = this.refusal(about);
    if (refusal) throw new Error(refusal);
    const { convention, grasps } = this.#setup;
    const posed = this.#frame ? product(this.#frame, T_scene_model) : T_scene_model;
    const scale = unitScale(about.library, about.scan);
    const own = Object.entries(grasps[model] ?? {});
    if (!own.length) return [{ grasp: "", numbers: robotPose(posed, about.scan, convention) }];
    return own.map(([grasp, rows]) => ({
      grasp,
      numbers: robotPose(product(posed, scaled(rows, scale)), about.scan, convention),
    }));
  }

  /** The table of `trivet recognize --robot-csv`. Errors: those of poses(). */
  table(scene, detections, about) {
    const { names, length } = kConventions[this.#setup.convention];
    const places = [..."xyz"].map((axis) => `${axis} [${length}]`);
    const head = ["scene", "model", "grasp", "score", "pose_score", "ambiguous", ...places, ...names, "frame"];
    const rows = detections.flatMap((detection) =>
      this.poses(detection, about).map(({ grasp, numbers }) => [
        scene,
        detection.model,
        grasp,
        rounded(detection.score),
        rounded(detection.score * detection.pose_share),
        detection.ambiguous ? 1 : 0,
        ...numbers.map(({ value }) => rounded(value)),
        this.frameName,
      ]),
    );
    return [head, ...rows].map((row) => row.map(csvField).join(",")).join("\n") + "\n";
  }
}

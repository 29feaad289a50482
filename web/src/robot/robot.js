import { fetchRobotPoses } from "../service.js";
import { keep, recall } from "../storage.js";
import { unitScale } from "../units.js";
import { lengthWords } from "../words.js";
import { checkedName, frameText, kSceneFrame, readFrame, readGrasps, scaled } from "./frames.js";

const kRemembered = "trivet.robot";
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
    return { ...kept, frame: typeof frame === "string" ? frame : frameText(frame) };
  } catch {
    return kDefaults;
  }
}

const convertedGrasps = (grasps, scale) =>
  Object.fromEntries(
    Object.entries(grasps).map(([model, own]) => [
      model,
      Object.fromEntries(Object.entries(own).map(([grasp, rows]) => [grasp, scaled(rows, scale)])),
    ]),
  );

/**
 * The robot for which poses are shown: the convention of its controller, its frame, its grasps.
 *
 * The service converts the poses. A refused or doubtful input is part of the setup. No pose is shown
 * meanwhile, since it could only be in a frame that the user has given up.
 */
export class Robot {
  #setup = remembered();
  // T_robot_scene in the scan's unit; null: none is given, or it is refused.
  #frame = null;
  #fault = "";
  #answer = null;
  #poses = null;
  #hasFailed = false;

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

  /** What the poses are of: { scene: its name, unit: of the scan, detections }, or null. */
  get answer() {
    return this.#answer;
  }

  set answer(answer) {
    this.#answer = answer;
    this.#poses = null;
  }

  /** Replaces a remembered convention that the service does not have. */
  takeConventions(names) {
    if (!names.includes(this.#setup.convention)) this.change({ convention: kDefaults.convention });
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
    this.#poses = null;
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
   * The poses of all detections by the current setup, or why there are none.
   *
   * Returns a promise, the same until the setup or the answer changes, of { refusal: a sentence, or
   *   "" when there are poses; doubt: lengths that probably have another unit, to be confirmed:
   *   { unit: as read, likelier: the other, accept(), convert() }; posesOf(detection): [{ grasp: ""
   *   for the model's own frame, numbers: [{ name, value, unit }] }]; table: that of `trivet
   *   recognize --robot-csv` }.
   */
  poses() {
    this.#poses ??= this.#fetchPoses();
    return this.#poses;
  }

  /** Whether these poses(), asked for earlier, are still those of the setup and the answer. */
  isCurrent(poses) {
    return poses === this.#poses;
  }

  /** Lets poses() ask again if the service did not answer. */
  retry() {
    if (this.#hasFailed) this.#poses = null;
    this.#hasFailed = false;
  }

  async #fetchPoses() {
    const fault = this.#fault || this.#setup.graspsFault;
    if (fault) return { refusal: fault };
    const { detections } = this.#answer;
    try {
      const { poses, table, doubts } = await fetchRobotPoses(this.#request());
      const doubt = doubts.map((one) => this.#doubtOf(one)).find(Boolean);
      if (doubt) return { refusal: doubt.words, doubt };
      return { refusal: "", table, posesOf: (detection) => poses[detections.indexOf(detection)] };
    } catch (error) {
      this.#hasFailed = true;
      return { refusal: error.message };
    }
  }

  #request() {
    const { convention, frameName, grasps } = this.#setup;
    const { scene, unit, detections } = this.#answer;
    const told = ({ model, score, pose_share, ambiguous, T_scene_model }) => ({
      model,
      score,
      pose_share,
      ambiguous,
      T_scene_model,
    });
    return {
      convention,
      scene,
      unit,
      frame: this.#frame && { name: frameName, T_robot_scene: this.#frame },
      grasps,
      detections: detections.map(told),
    };
  }

  /** A doubt of the service in words, with its remedies; null: the user has confirmed the unit. */
  #doubtOf({ about, model, length, unit, likelier }) {
    const scale = unitScale(likelier, unit);
    if (about === "frame") {
      if (this.#setup.frameUnit === unit) return null;
      return {
        words:
          `The calibration moves by ${lengthWords(length, unit)}, if it is in ${unit} like the ` +
          `scan: its lengths look like ${likelier}.`,
        unit,
        likelier,
        accept: () => this.change({ frameUnit: unit }),
        convert: () => this.change({ frame: frameText(scaled(this.#frame, scale)) }),
      };
    }
    if (this.#setup.graspsUnit === unit) return null;
    return {
      words:
        `Grasps of ${model} are up to ${lengthWords(length, unit)} from its origin, if they are ` +
        `in ${unit} like the library: their lengths look like ${likelier}.`,
      unit,
      likelier,
      accept: () => this.change({ graspsUnit: unit }),
      convert: () => this.change({ grasps: convertedGrasps(this.#setup.grasps, scale) }),
    };
  }
}

import { keep, recall } from "../storage.js";
import { unitScale } from "../units.js";
import { kConventions, robotPose } from "./conventions.js";
import { product, readFrame, readGrasps, scaled } from "./frames.js";

const kRemembered = "trivet.robot";
const kDigits = 7; // of a table, as of `trivet recognize --robot-csv`

function remembered() {
  try {
    const { convention, frame, grasps } = JSON.parse(recall(kRemembered));
    return {
      convention: convention in kConventions ? convention : "quaternion",
      frame: frame && readFrame(JSON.stringify(frame)),
      grasps: readGrasps(JSON.stringify(grasps)),
    };
  } catch {
    return { convention: "quaternion", frame: null, grasps: {} };
  }
}

const rounded = (value) => Number(value.toPrecision(kDigits));
const csvField = (value) => (/[",\n]/.test(value) ? `"${value.replaceAll('"', '""')}"` : `${value}`);

/** What poses are told to: how its controller writes them, where it stands, what it grasps. */
export class Robot {
  #setup = remembered();

  /** { convention, frame: T_robot_scene in the scan's unit or null, grasps: in the library's } */
  get setup() {
    return this.#setup;
  }

  /** Change some of the setup; the browser remembers it. */
  change(some) {
    this.#setup = { ...this.#setup, ...some };
    keep(kRemembered, JSON.stringify(this.#setup));
  }

  /**
   * What the robot is told of a detection: [{ grasp, numbers: [{ name, value, unit }] }], one for
   * each grasp of its model, or one of no name for the model's own frame.
   *
   * units  { scan, library }
   */
  poses({ model, T_scene_model }, units) {
    const { convention, frame, grasps } = this.#setup;
    const posed = frame ? product(frame, T_scene_model) : T_scene_model;
    const scale = unitScale(units.library, units.scan);
    const own = Object.entries(grasps[model] ?? {});
    if (!own.length) return [{ grasp: "", numbers: robotPose(posed, units.scan, convention) }];
    return own.map(([grasp, rows]) => ({
      grasp,
      numbers: robotPose(product(posed, scaled(rows, scale)), units.scan, convention),
    }));
  }

  /** The table of `trivet recognize --robot-csv`. */
  table(scene, detections, units) {
    const { names, length } = kConventions[this.#setup.convention];
    const places = [..."xyz"].map((axis) => `${axis} [${length}]`);
    const head = ["scene", "model", "grasp", "score", "pose_score", "ambiguous", ...places, ...names];
    const rows = detections.flatMap((detection) =>
      this.poses(detection, units).map(({ grasp, numbers }) => [
        scene,
        detection.model,
        grasp,
        rounded(detection.score),
        rounded(detection.score * detection.pose_share),
        detection.ambiguous ? 1 : 0,
        ...numbers.map(({ value }) => rounded(value)),
      ]),
    );
    return [head, ...rows].map((row) => row.map(csvField).join(",")).join("\n") + "\n";
  }
}

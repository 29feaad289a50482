import { copiesOnClick } from "../copy.js";
import { element, terms } from "../dom.js";
import { conventionOptions } from "./convention_options.js";

const kDigits = { mm: 2, m: 5, deg: 3, rad: 5, "": 5 }; // after the point, by unit
const kCopiedDigits = 12;

/** One number a line, with its name and unit. */
const copiedText = (numbers) =>
  numbers
    .map(({ name, value, unit }) => `${name} ${Number(value.toPrecision(kCopiedDigits))} ${unit}`)
    .map((line) => line.trimEnd())
    .join("\n");

function numberTerms(numbers) {
  const row = (some) => {
    const [{ unit }] = some;
    const shown = some.map(({ value }) => value.toFixed(kDigits[unit]).replace("-", "−"));
    return [some.map(({ name }) => name).join(", "), `${shown.join(", ")} ${unit}`];
  };
  return terms([row(numbers.slice(0, 3)), row(numbers.slice(3))]);
}

function poseView({ grasp, numbers }, framed) {
  const copy = element("button", { type: "button" }, "Copy");
  copiesOnClick(copy, copiedText(numbers));
  const what = [grasp && `Grasp ${grasp}`, framed && "in the robot's frame"];
  const title = what.filter(Boolean).join(", ");
  return element("div", {}, title && element("p", {}, title), numberTerms(numbers), copy);
}

/**
 * The pose of a detection for the user's robot, to read and to copy.
 *
 * units     { scan, library }
 * onChange  called when another convention was chosen here
 */
export function robotPoseView(robot, detection, units, onChange) {
  const select = element("select", {}, conventionOptions());
  select.value = robot.setup.convention;
  const told = element("div", { role: "status" });
  const show = () => {
    const framed = robot.setup.frame !== null;
    told.replaceChildren(
      ...robot.poses(detection, units).map((pose) => poseView(pose, framed)),
    );
  };
  select.onchange = () => {
    robot.change({ convention: select.value });
    onChange();
    show();
  };
  show();
  return element("div", { className: "robot-pose" }, element("label", {}, "Pose for", select), told);
}

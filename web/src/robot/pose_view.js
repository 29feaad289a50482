import { copiesOnClick } from "../copy.js";
import { element, terms } from "../dom.js";
import { conventionOptions } from "./convention_options.js";

const kDigits = { mm: 2, m: 5, deg: 3, rad: 5, "": 5 }; // after the point, by unit
const kCopiedDigits = 12;

/** One number per line, with its name and unit. */
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

function poseView({ grasp, numbers }, frameName) {
  const copy = element("button", { type: "button" }, "Copy");
  copiesOnClick(copy, `${copiedText(numbers)}\nframe ${frameName}`);
  const title = [grasp && `Grasp ${grasp}`, `in frame ${frameName}`].filter(Boolean).join(", ");
  return element("div", {}, element("p", {}, title), numberTerms(numbers), copy);
}

/** The fault of the setup because of which no pose is shown. */
const refusalView = (refusal) => element("p", { className: "problem" }, `No pose is told. ${refusal}`);

/**
 * The pose of a detection for the user's robot, to read and to copy.
 *
 * about     see Robot
 * onChange  called when another convention is selected here
 */
export function robotPoseView(robot, detection, about, onChange) {
  const select = element("select", {}, conventionOptions());
  select.value = robot.setup.convention;
  const told = element("div", { role: "status" });
  const show = () => {
    const refusal = robot.refusal(about);
    if (refusal) return told.replaceChildren(refusalView(refusal));
    const views = robot.poses(detection, about).map((pose) => poseView(pose, robot.frameName));
    return told.replaceChildren(...views);
  };
  select.onchange = () => {
    robot.change({ convention: select.value });
    onChange();
    show();
  };
  show();
  return element("div", { className: "robot-pose" }, element("label", {}, "Pose for", select), told);
}

import { copiesOnClick } from "../copy.js";
import { element, terms } from "../dom.js";
import { conventionOptions } from "./convention_options.js";

// Digits after the point, by unit.
const kDigits = { mm: 2, m: 5, deg: 3, rad: 5, "": 5 };
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
 * detection  of robot.answer
 * onChange   called when another convention is selected here
 */
export function robotPoseView(robot, detection, onChange) {
  const select = element("select", {}, conventionOptions());
  select.value = robot.setup.convention;
  const status = element("div", { role: "status" });
  const show = async () => {
    status.replaceChildren();
    const asked = robot.poses();
    const { refusal, posesOf } = await asked;
    if (!robot.isCurrent(asked)) return;
    if (refusal) return status.replaceChildren(refusalView(refusal));
    const views = posesOf(detection).map((pose) => poseView(pose, robot.frameName));
    status.replaceChildren(...views);
  };
  select.onchange = () => {
    robot.change({ convention: select.value });
    onChange();
    show();
  };
  robot.retry();
  show();
  return element("div", { className: "robot-pose" }, element("label", {}, "Pose for", select), status);
}

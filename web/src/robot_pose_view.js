import { copiesOnClick } from "./copy.js";
import { element, terms } from "./dom.js";
import { kConventions, robotPose } from "./robot_pose.js";
import { keep, recall } from "./storage.js";

const kDigits = { mm: 2, m: 5, deg: 3, rad: 5, "": 5 }; // after the point, by unit
const kCopiedDigits = 12;
const kRemembered = "trivet.robot";

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

/** The pose for the robot that the user chooses, to read and to copy. */
export function robotPoseView(rows, unit) {
  const select = element(
    "select",
    {},
    Object.entries(kConventions).map(([value, { label }]) => element("option", { value }, label)),
  );
  const known = recall(kRemembered);
  if (known in kConventions) select.value = known;
  const told = element("div", { role: "status" });
  const copy = element("button", { type: "button" });
  const show = () => {
    const numbers = robotPose(rows, unit, select.value);
    told.replaceChildren(numberTerms(numbers));
    copy.textContent = "Copy";
    copiesOnClick(copy, copiedText(numbers));
  };
  select.onchange = () => {
    keep(kRemembered, select.value);
    show();
  };
  show();
  return element(
    "div",
    { className: "robot-pose" },
    element("label", {}, "Pose for", select),
    copy,
    told,
  );
}

/** Poses as controllers of robots take them. */
import { kConventions, robotPose } from "../src/robot_pose.js";
import { expect, foundRows, openExample, test } from "./fixtures.js";

const product = (a, b) =>
  a.map((row) => b[0].map((_, j) => row.reduce((sum, x, k) => sum + x * b[k][j], 0)));
const turnX = (t) => [
  [1, 0, 0],
  [0, Math.cos(t), -Math.sin(t)],
  [0, Math.sin(t), Math.cos(t)],
];
const turnY = (t) => [
  [Math.cos(t), 0, Math.sin(t)],
  [0, 1, 0],
  [-Math.sin(t), 0, Math.cos(t)],
];
const turnZ = (t) => [
  [Math.cos(t), -Math.sin(t), 0],
  [Math.sin(t), Math.cos(t), 0],
  [0, 0, 1],
];
const radians = (degrees) => (degrees * Math.PI) / 180;

/** About an axis, by Rodrigues. */
function turnAbout(vector) {
  const angle = Math.hypot(...vector);
  const [x, y, z] = angle ? vector.map((value) => value / angle) : [0, 0, 1];
  const cross = [
    [0, -z, y],
    [z, 0, -x],
    [-y, x, 0],
  ];
  const twice = product(cross, cross);
  return [0, 1, 2].map((i) =>
    [0, 1, 2].map(
      (j) => (i === j) + Math.sin(angle) * cross[i][j] + (1 - Math.cos(angle)) * twice[i][j],
    ),
  );
}

/** A point turned by a quaternion: q p q*. */
function turnByQuaternion([x, y, z, w]) {
  const times = ([a, b, c, d], [e, f, g, h]) => [
    d * e + a * h + b * g - c * f,
    d * f - a * g + b * h + c * e,
    d * g + a * f - b * e + c * h,
    d * h - a * e - b * f - c * g,
  ];
  const columns = [0, 1, 2].map((k) => {
    const unit = [0, 0, 0, 0];
    unit[k] = 1;
    return times(times([x, y, z, w], unit), [-x, -y, -z, w]);
  });
  return [0, 1, 2].map((i) => [0, 1, 2].map((j) => columns[j][i]));
}

/** Back to the matrix, by the definitions in the controllers' manuals. */
const kMatrixOf = {
  quaternion: (q) => turnByQuaternion(q),
  abb: ([w, x, y, z]) => turnByQuaternion([x, y, z, w]),
  rpy: ([roll, pitch, yaw]) => product(product(turnZ(yaw), turnY(pitch)), turnX(roll)),
  kuka: (abc) => {
    const [a, b, c] = abc.map(radians);
    return product(product(turnZ(a), turnY(b)), turnX(c));
  },
  fanuc: (wpr) => {
    const [w, p, r] = wpr.map(radians);
    return product(turnZ(r), product(turnY(p), turnX(w)));
  },
  ur: turnAbout,
};
const kLength = { quaternion: "m", rpy: "m", ur: "m", kuka: "mm", fanuc: "mm", abb: "mm" };

const kTurns = [
  [0, 0, 0],
  [Math.PI, 0, 0],
  [0, Math.PI, 0],
  [0, 0, Math.PI],
  [0.3, -1.2, 2.5],
  [-2, 1.5, -1],
  [1e-9, 0, 0],
  [1.8, 1.8, 1.7],
];
const kUpright = [1, -1].flatMap((sign) =>
  [0, 0.7, -2].map((yaw) => product(turnZ(yaw), turnY((sign * Math.PI) / 2))),
);

test("every convention turns back into the rotation that it tells", () => {
  for (const rotation of [...kTurns.map(turnAbout), ...kUpright]) {
    const rows = rotation.map((row, k) => [...row, [0.125, -2.5, 3][k]]);
    for (const convention of Object.keys(kConventions)) {
      const told = robotPose(rows, "m", convention);
      const scale = { m: 1, mm: 1000 }[kLength[convention]];
      expect(told.slice(0, 3).map(({ value }) => value)).toEqual(
        [0.125, -2.5, 3].map((x) => scale * x),
      );
      expect(told.slice(0, 3).map(({ unit }) => unit)).toEqual(Array(3).fill(kLength[convention]));
      const back = kMatrixOf[convention](told.slice(3).map(({ value }) => value));
      back.flat().forEach((value, k) => expect(value).toBeCloseTo(rotation.flat()[k], 9));
    }
  }
});

test("what a convention leaves open is settled as in the CSV of the program", () => {
  const orientation = (rotation, convention) =>
    robotPose(
      rotation.map((row) => [...row, 0]),
      "mm",
      convention,
    )
      .slice(3)
      .map(({ value }) => value);
  for (const rotation of kUpright) {
    expect(orientation(rotation, "rpy")[0]).toBe(0);
    expect(orientation(rotation, "kuka")[2]).toBe(0);
    expect(Math.abs(orientation(rotation, "fanuc")[1])).toBeCloseTo(90, 12);
  }
  expect(orientation(turnAbout([0, 0, 0]), "ur")).toEqual([0, 0, 0]);
  for (const turn of kTurns) {
    expect(orientation(turnAbout(turn), "quaternion")[3]).toBeGreaterThanOrEqual(0);
    expect(orientation(turnAbout(turn), "abb")[0]).toBeGreaterThanOrEqual(0);
  }
});

test("a detection's pose is copied for the robot that was chosen, and the choice is kept", async ({
  page,
  context,
}) => {
  await context.grantPermissions(["clipboard-read", "clipboard-write"]);
  const { detections } = await openExample(page);
  await foundRows(page).first().click();
  await page.getByLabel("Pose for").selectOption("kuka");
  await page.getByRole("button", { name: "Copy", exact: true }).click();
  await expect(page.getByRole("button", { name: "Copied" })).toBeVisible();
  const lines = (await page.evaluate(() => navigator.clipboard.readText())).split("\n");
  expect(lines.map((line) => line.replace(/ .* /, " "))).toEqual(
    ["x mm", "y mm", "z mm", "A deg", "B deg", "C deg"],
  );
  const numbers = lines.map((line) => Number(line.split(" ")[1]));
  const rows = detections[0].T_scene_model.slice(0, 3);
  rows.forEach((row, k) => expect(numbers[k]).toBeCloseTo(1000 * row[3], 6));
  const back = kMatrixOf.kuka(numbers.slice(3));
  // Poses are of floats: that near to a rotation.
  rows.forEach((row, i) => row.slice(0, 3).forEach((x, j) => expect(back[i][j]).toBeCloseTo(x, 6)));
  await foundRows(page).nth(1).click();
  await expect(page.getByLabel("Pose for").filter({ visible: true })).toHaveValue("kuka");
});

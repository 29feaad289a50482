/** Poses as controllers of robots take them. */
import { execFileSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";

import { readFrame, readGrasps } from "../src/robot/frames.js";
import { exampleFiles, expect, foundRows, openExample, test } from "./fixtures.js";

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

/** The rotation of angles in the convention of KUKA. */
function rotationOfKuka(abc) {
  const [a, b, c] = abc.map(radians);
  return product(product(turnZ(a), turnY(b)), turnX(c));
}

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
    ["x mm", "y mm", "z mm", "A deg", "B deg", "C deg", "frame scene"],
  );
  const numbers = lines.slice(0, -1).map((line) => Number(line.split(" ")[1]));
  const rows = detections[0].T_scene_model.slice(0, 3);
  rows.forEach((row, k) => expect(numbers[k]).toBeCloseTo(1000 * row[3], 6));
  const back = rotationOfKuka(numbers.slice(3));
  // Poses are of floats: that near to a rotation.
  rows.forEach((row, i) => row.slice(0, 3).forEach((x, j) => expect(back[i][j]).toBeCloseTo(x, 6)));
  await foundRows(page).nth(1).click();
  await expect(page.getByLabel("Pose for").filter({ visible: true })).toHaveValue("kuka");
});

const kHandEye = [
  [0.36, 0.48, -0.8, 0.5],
  [-0.8, 0.6, 0, -0.25],
  [0.48, 0.64, 0.6, 0.75],
  [0, 0, 0, 1],
];
const moved = (x, y, z) => [
  [0, 0, 1, x],
  [1, 0, 0, y],
  [0, 1, 0, z],
  [0, 0, 0, 1],
];

/** Fields of each row; those in quotes have commas. */
const readTable = (file) =>
  readFileSync(file, "utf8")
    .trim()
    .split("\n")
    .map((line) => [...line.matchAll(/(?:^|,)(?:"([^"]*)"|([^,]*))/g)].map((m) => m[1] ?? m[2]));

test("the table has the numbers of the program's, in the robot's frame, for each grasp", async ({
  page,
  request,
}, testInfo) => {
  const scene = await openExample(page);
  const [first, other] = new Set(scene.detections.map(({ model }) => model));
  const grasps = { [first]: { rim: moved(0.01, 0, 0), "inner, left": moved(0, 0.02, -0.01) } };
  const files = {
    hand_eye: JSON.stringify(kHandEye),
    grasps: JSON.stringify(grasps),
  };
  for (const [name, text] of Object.entries(files))
    writeFileSync(testInfo.outputPath(`${name}.json`), text);
  await page.getByText("For a robot").click();
  await page.getByLabel("Controller").selectOption("kuka");
  await page.locator("#frame-file").setInputFiles(testInfo.outputPath("hand_eye.json"));
  await page.locator("#grasps-file").setInputFiles(testInfo.outputPath("grasps.json"));
  await expect(page.locator("#grasps-note")).toHaveText("2 grasps of 1 model");
  const [download] = await Promise.all([
    page.waitForEvent("download"),
    page.getByRole("link", { name: "Download table" }).click(),
  ]);
  expect(download.suggestedFilename()).toMatch(/\.robot\.kuka\.csv$/);
  const told = readTable(await download.path());

  const [scan, camera] = await exampleFiles(request);
  writeFileSync(testInfo.outputPath(scan.name), scan.buffer);
  writeFileSync(testInfo.outputPath("camera.json"), camera.buffer);
  const words = ["--camera", "camera.json", "--robot", "kuka", "--robot-csv", "poses.csv"];
  execFileSync(
    process.env.TRIVET_PROGRAM,
    ["recognize", process.env.TRIVET_LIBRARY, scan.name, ...words]
      .concat(["--robot-frame", "hand_eye.json", "--grasps", "grasps.json", "--json", "-"]),
    { cwd: testInfo.outputPath("."), stdio: "pipe" },
  );
  const expected = readTable(testInfo.outputPath("poses.csv"));
  expect(told[0]).toEqual(expected[0]);
  expect(told.length).toBe(expected.length);
  told.slice(1).forEach(([, model, grasp, ...values], k) => {
    const [, otherModel, otherGrasp, ...others] = expected[k + 1];
    const numbers = values.slice(0, -1);
    expect([model, grasp, values[numbers.length]]).toEqual([otherModel, otherGrasp, "robot"]);
    numbers.forEach((number, i) => expect(Number(number)).toBeCloseTo(Number(others[i]), 3));
  });
  expect(told.slice(1).some(([, model, grasp]) => model === other && grasp === "")).toBe(
    other !== undefined,
  );
});

const kQuarter = "0 0 1 0.5, 1 0 0 0.2; 0 1 0 0.75\n0 0 0 1";
const kQuarterRows = "0 0 1 0.5\n1 0 0 0.2\n0 1 0 0.75\n0 0 0 1";

/** Open an example with the robot's form, in meters, and the pose of the first detection. */
async function openRobot(page) {
  await openExample(page);
  await page.getByText("For a robot").click();
  await foundRows(page).first().click();
}

async function setFrame(page, text) {
  const frame = page.getByLabel("Hand-eye calibration");
  await frame.fill(text);
  await frame.blur();
}

async function expectRefused(page, words) {
  await expect(page.getByRole("button", { name: "Copy table" })).toBeDisabled();
  await expect(page.locator("#download-robot")).not.toHaveAttribute("href");
  await expect(page.locator(".robot-pose").first()).toContainText("No pose is told.");
  await expect(page.locator(".robot-pose").first()).toContainText(words);
  await expect(page.locator(".robot-pose").first().getByRole("button")).toHaveCount(0);
}

/** The table as it would be downloaded: { file, rows: by the names of their columns }. */
async function downloadedTable(page) {
  const [download] = await Promise.all([
    page.waitForEvent("download"),
    page.getByRole("link", { name: "Download table" }).click(),
  ]);
  const [names, ...rows] = readTable(await download.path());
  return {
    file: download.suggestedFilename(),
    rows: rows.map((row) => Object.fromEntries(names.map((name, k) => [name, row[k]]))),
  };
}

test("while a calibration is refused no pose is told, also after the page was opened anew", async ({
  page,
}) => {
  await openRobot(page);
  await setFrame(page, kQuarter);
  const frame = page.getByLabel("Hand-eye calibration");
  await expect(frame).toHaveValue(kQuarterRows);
  await page.getByLabel("Name of the robot's frame").fill("cell-2");
  await page.getByLabel("Name of the robot's frame").blur();
  await expect(page.getByText("in frame cell-2").first()).toBeVisible();
  const before = await downloadedTable(page);
  expect(before.file).toMatch(/\.cell-2\.quaternion\.csv$/);
  expect(before.rows.map((row) => row.frame)).toEqual(Array(before.rows.length).fill("cell-2"));

  const wrong = "0 0 1 0.5, 1 0 0 0.2; 0 1 0 0.75";
  await setFrame(page, wrong);
  const reason = "The calibration is not taken: expected four rows of four numbers, found 12 of 16.";
  await expect(page.locator("#frame-note")).toHaveText(reason);
  await expect(frame).toHaveAttribute("aria-invalid", "true");
  await expectRefused(page, reason);
  await openRobot(page);
  await expect(frame).toHaveValue(wrong);
  await expectRefused(page, reason);

  await setFrame(page, "");
  await expect(page.getByText("in frame scene").first()).toBeVisible();
  const without = await downloadedTable(page);
  expect(without.file).toMatch(/\.scene\.quaternion\.csv$/);
  expect(without.rows[0].frame).toBe("scene");
  await setFrame(page, kQuarter);
  expect(await downloadedTable(page)).toEqual(before);
  for (const name of ["", "my cell", "Scene", "a/b"]) {
    await page.getByLabel("Name of the robot's frame").fill(name);
    await page.getByLabel("Name of the robot's frame").blur();
    await expectRefused(page, `found “${name}”`);
  }
});

test("while grasps are refused no pose is told", async ({ page }) => {
  await openRobot(page);
  const choose = (name, text) =>
    page
      .locator("#grasps-file")
      .setInputFiles({ name, mimeType: "application/json", buffer: Buffer.from(text) });
  await choose("bad.json", '{"cup": {"rim": [[1, 0], [0, 1]]}}');
  await expectRefused(page, "The grasps are not taken: bad.json: cup, rim: expected four rows");
  await page.getByRole("button", { name: "Forget the grasps" }).click();
  await expect(page.getByText("in frame scene").first()).toBeVisible();
  await expect(page.getByRole("button", { name: "Copy table" })).toBeEnabled();
});

test("lengths that look like those of another unit are asked about before they are used", async ({
  page,
  request,
}) => {
  const { unit, models } = await (await request.get("/v1/models")).json();
  expect(unit).toBe("m");
  await openRobot(page);
  await setFrame(page, kQuarter);
  const before = await downloadedTable(page);
  await setFrame(page, "0 0 1 500 1 0 0 200 0 1 0 750 0 0 0 1");
  await expectRefused(page, "its lengths look like mm");
  await page.getByRole("button", { name: "They are in mm: convert them to m" }).click();
  await expect(page.getByLabel("Hand-eye calibration")).toHaveValue(kQuarterRows);
  expect(await downloadedTable(page)).toEqual(before);

  await setFrame(page, "1 0 0 60 0 1 0 0 0 0 1 0 0 0 0 1");
  await expectRefused(page, "its lengths look like mm");
  await page.getByRole("button", { name: "They are in m, as they are" }).click();
  expect(Number((await downloadedTable(page)).rows[0]["x [m]"])).toBeGreaterThan(59);
  // The answer to the question is kept.
  await openRobot(page);
  expect(Number((await downloadedTable(page)).rows[0]["x [m]"])).toBeGreaterThan(59);

  const grasps = { [models[0].name]: { rim: moved(20, 0, 5) } };
  await page.locator("#grasps-file").setInputFiles({
    name: "grasps.json",
    mimeType: "application/json",
    buffer: Buffer.from(JSON.stringify(grasps)),
  });
  await expectRefused(page, `Grasps of ${models[0].name} are up to 20.6 m from its origin`);
  await page.getByRole("button", { name: "They are in mm: convert them to m" }).click();
  await expect(page.getByRole("button", { name: "Copy table" })).toBeEnabled();
});

test.describe("a service that is busy", () => {
  test.use({ allowed: /503/ });

  test("no table of another setup is offered while the service makes one, nor without it", async ({
    page,
  }) => {
    await openRobot(page);
    await expect(page.getByRole("button", { name: "Copy table" })).toBeEnabled();
    let answer;
    await page.route("**/v1/robot-poses", async (route) => {
      await new Promise((resolve) => (answer = resolve));
      await route.fulfill({ status: 503, json: { error: "no room" } });
    });
    await page.getByLabel("Controller").selectOption("abb");
    await expect(page.getByRole("button", { name: "Copy table" })).toBeDisabled();
    await expect(page.locator("#download-robot")).not.toHaveAttribute("href");
    await expect(page.locator(".robot-pose").first().getByRole("button")).toHaveCount(0);
    await expect.poll(() => Boolean(answer)).toBe(true);
    answer();
    await expectRefused(page, "The service is busy: no room.");
    await page.unroute("**/v1/robot-poses");
    await page.getByLabel("Controller").selectOption("kuka");
    expect((await downloadedTable(page)).file).toMatch(/\.scene\.kuka\.csv$/);
  });
});

test("frames that are none are refused with the reason", () => {
  expect(() => readFrame("1 0 0 0 0 1 0 0 0 0 -1 0 0 0 0 1")).toThrow("a rotation");
  expect(() => readFrame("2 0 0 0 0 2 0 0 0 0 2 0 0 0 0 1")).toThrow("a rotation");
  expect(() => readFrame("1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1")).toThrow("0 0 0 1");
  for (const entry of ["null", '"0"', "false", "[]"]) {
    const text = `[[1, 0, 0, ${entry}], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]`;
    expect(() => readFrame(text), text).toThrow("four rows of four numbers");
  }
  expect(() => readGrasps("[1]")).toThrow("MODEL");
  expect(() => readGrasps('{"cup": {"rim": [[1, 0], [0, 1]]}}')).toThrow("cup, rim: ");
});

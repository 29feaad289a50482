/** From a scan to a look at what was found in it. */
import { gzipSync } from "node:zlib";

import {
  atRest,
  chooseFiles,
  drawn,
  drop,
  exampleFiles,
  expect,
  foundRows,
  lookedAt,
  openExample,
  openPage,
  pixels,
  recognized,
  test,
} from "./fixtures.js";

/** As the report and the terminal write it. */
const scoreText = (score) => (score > 0.999 ? "> 0.999" : score.toFixed(3));
const position = (pose) => pose.T_scene_model.slice(0, 3).map((row) => row[3]);
const distance = (a, b) => Math.hypot(...a.map((value, k) => value - b[k]));

async function diameterOf(request, name) {
  const { models } = await (await request.get("/v1/models")).json();
  return models.find((model) => model.name === name).diameter;
}

/** How many pixels around a mark have about the hue of a color. */
async function pixelsOfHue(page, mark, [r, g, b]) {
  const box = await mark.boundingBox();
  const clip = { x: box.x - 25, y: box.y - 25, width: box.width + 50, height: box.height + 50 };
  const data = await pixels(page, clip);
  const chroma = (...rgb) => {
    const mean = (rgb[0] + rgb[1] + rgb[2]) / 3;
    const off = rgb.map((value) => value - mean);
    return { off, length: Math.hypot(...off) };
  };
  const wanted = chroma(r, g, b);
  let count = 0;
  for (let i = 0; i < data.length; i += 4) {
    const { off, length } = chroma(data[i], data[i + 1], data[i + 2]);
    const along = off.reduce((sum, value, k) => sum + value * wanted.off[k], 0);
    if (length > 15 && along > 0.9 * length * wanted.length) ++count;
  }
  return count;
}

test("an example is shown with what the service found in it", async ({ page }) => {
  const { detections, points } = await openExample(page);
  expect(detections.length).toBeGreaterThan(0);
  await expect(page.locator("#headline")).toHaveText(new RegExp(`^${detections.length} found in `));
  await expect(page.locator("#scan-facts")).toContainText(`${points.toLocaleString("en")} point`);
  const rows = foundRows(page);
  await expect(rows).toHaveCount(detections.length);
  for (const [k, detection] of detections.entries()) {
    await expect(rows.nth(k).locator(".name")).toContainText(detection.model);
    await expect(rows.nth(k).locator(".score")).toContainText(scoreText(detection.score));
    await expect(rows.nth(k).locator(".note")).toContainText(
      `${Math.round(100 * detection.visible_fraction)} % visible`,
    );
    expect(await rows.nth(k).locator(".tag").count()).toBe(detection.ambiguous ? 1 : 0);
  }
});

test("models are drawn in their colors where they were found", async ({ page }) => {
  await openExample(page);
  const color = await page
    .locator("#found .swatch")
    .first()
    .evaluate((swatch) => getComputedStyle(swatch).backgroundColor.match(/\d+/g).map(Number));
  const mark = page.locator(".mark.found").first();
  expect(await pixelsOfHue(page, mark, color)).toBeGreaterThan(100);
  const box = await mark.boundingBox();
  await page.keyboard.press("d");
  await expect(mark).toBeHidden();
  expect(await pixelsOfHue(page, { boundingBox: () => box }, color)).toBeLessThan(20);
});

test("a detection that is clicked is looked at, and says what its score is made of", async ({
  page,
  request,
}) => {
  const { detections } = await openExample(page);
  const before = await lookedAt(page);
  const last = detections.length - 1;
  await foundRows(page).nth(last).click();
  await expect(foundRows(page).nth(last)).toHaveAttribute("aria-expanded", "true");
  const reach = await diameterOf(request, detections[last].model);
  await expect
    .poll(async () => distance(await lookedAt(page), position(detections[last])))
    .toBeLessThan(reach);
  expect(distance(await lookedAt(page), before)).toBeGreaterThan(0);
  await expect(page.getByText("What the score is made of")).toBeVisible();
  await page.keyboard.press("Escape");
  await expect(foundRows(page).nth(last)).toHaveAttribute("aria-expanded", "false");
});

/** The numbers of the open pose's score: [label, number], the sum last. */
const scoreRows = (page) =>
  page.locator(".details:not([hidden]) .score-bars > li").evaluateAll((rows) =>
    rows.map((row) => [
      row.querySelector(".label").textContent,
      Number(row.querySelector(".number").textContent.split(" of ")[0].replace("−", "-")),
    ]),
  );

test("the rows of a score add up to it, what other answers take off among them", async ({
  page,
  request,
}) => {
  // As if another answer had halved the odds of the first pose, and a like one had been rejected.
  await page.route("**/v1/recognize?*", async (route) => {
    const response = await route.fetch();
    const answer = await response.json();
    const [scene] = answer.scenes;
    const [first] = scene.detections;
    const refused = { reason: "too_low", words: "below 0.8", explained_by: null };
    scene.rejected = [{ ...first, ...refused, score: 0.5, explained_share: 0 }];
    first.score = first.score / (2 - first.score);
    await route.fulfill({ response, json: answer });
  });
  const { detections, rejected } = await openExample(page);
  const { bias, parts } = await (await request.get("/v1/score-parts")).json();
  await page.keyboard.press("r");
  for (const [list, pose] of [
    ["found", detections[0]],
    ["rejected", rejected[0]],
  ]) {
    await page.locator(`#${list} button.pose`).first().click();
    const rows = await scoreRows(page);
    const { correlation } = pose.parts;
    const alone = parts.reduce(
      (sum, { name }) => sum + pose.evidence[name],
      bias[0] + (bias[1] - bias[0]) * correlation,
    );
    const sum = Math.log(pose.score / (1 - pose.score));
    const rounding = 0.05 * rows.length;
    const numbers = Object.fromEntries(rows);
    expect(Math.abs(numbers["log odds"] - sum)).toBeLessThan(0.051);
    expect(Math.abs(numbers["other answers"] - (sum - alone))).toBeLessThan(0.051);
    const all = rows.slice(0, -1).reduce((total, [, number]) => total + number, 0);
    expect(Math.abs(all - numbers["log odds"])).toBeLessThan(rounding);
  }
});

test("a pose tells how it is turned", async ({ page }) => {
  const { detections } = await openExample(page);
  await foundRows(page).first().click();
  const term = (name) =>
    page.locator("#found .terms > div", { hasText: name }).locator("dd").first().textContent();
  const numbers = (text) => text.match(/−?[\d.]+/g).map((part) => Number(part.replace("−", "-")));
  const [x, y, z, w] = numbers(await term("quaternion"));
  const rows = [
    [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
    [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
    [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
  ];
  rows.forEach((row, k) =>
    row.forEach((value, j) =>
      expect(Math.abs(value - detections[0].T_scene_model[k][j])).toBeLessThan(1e-3),
    ),
  );
  const [angle, ...axis] = numbers(await term("turned by"));
  expect(Math.abs(Math.cos((angle * Math.PI) / 360) - w)).toBeLessThan(1e-3);
  expect(Math.abs(Math.hypot(...axis) - 1)).toBeLessThan(0.02);
});

test("a pose tells how far off it may be", async ({ page }) => {
  const { detections } = await openExample(page);
  await foundRows(page).first().click();
  const words = await page
    .locator("#found .terms > div", { hasText: "how sure" })
    .locator("dd")
    .first()
    .textContent();
  const numbers = words.match(/[\d.]+/g).map(Number);
  const { translation, rotation_deg: turns } = detections[0].pose_sigma;
  expect(numbers).toHaveLength(6);
  const millimeters = translation.map((length) => 1000 * length); // the example is in meters
  [...millimeters, ...turns].forEach((value, k) =>
    expect(Math.abs(numbers[k] - value)).toBeLessThan(0.06 * value + 1e-3),
  );
  expect(words).toContain("mm along the model's x, y, z");
});

test("of an object beyond the scan's border it is said what is outside", async ({ page }) => {
  await page.route("**/v1/recognize?*", async (route) => {
    const response = await route.fetch();
    const answer = await response.json();
    Object.assign(answer.scenes[0].detections[0], {
      visible_fraction: 0.25,
      hidden_fraction: 0.1,
      outside_fraction: 0.6,
    });
    await route.fulfill({ response, json: answer });
  });
  await openExample(page);
  await expect(foundRows(page).first().locator(".note")).toContainText(
    "25 % visible, 10 % hidden, 60 % outside the scan",
  );
});

test("labels lie on what is seen of their models", async ({ page }) => {
  await openExample(page);
  await page.getByRole("application").focus();
  for (let k = 0; k < 5; ++k) await page.keyboard.press("ArrowDown"); // one behind the other
  await atRest(page);
  const marks = page.locator(".mark.found:not(.behind)");
  const count = await marks.count();
  expect(count).toBeGreaterThan(0);
  for (let k = 0; k < count; ++k) {
    const label = await marks.nth(k).textContent();
    const { x, y, width, height } = await marks.nth(k).boundingBox();
    await page.mouse.click(x + width / 2, y + height / 2);
    await expect(page.locator('#found [aria-expanded="true"] .label')).toHaveText(label);
    await page.keyboard.press("f");
    await page.getByRole("application").focus();
    for (let n = 0; n < 5; ++n) await page.keyboard.press("ArrowDown");
    await atRest(page);
  }
});

test("a reason is in the words of the service, with the place of what explains the pose", async ({
  page,
}) => {
  const words = "place taken: 83 % of its pixels are explained by gear";
  await page.route("**/v1/recognize?*", async (route) => {
    const response = await route.fetch();
    const answer = await response.json();
    const [scene] = answer.scenes;
    const refused = { reason: "explained", words, explained_by: 1, explained_share: 0.83 };
    scene.rejected = [{ ...scene.detections[0], ...refused, score: 0.9 }];
    await route.fulfill({ response, json: answer });
  });
  await openExample(page);
  await page.keyboard.press("r");
  await expect(page.locator("#rejected .note")).toHaveText(`${words} (2)`);
});

test("a model that is clicked in the view is opened in the list", async ({ page }) => {
  await openExample(page);
  const mark = page.locator(".mark.found").first();
  const box = await mark.boundingBox();
  await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  await expect(page.locator('#found [aria-expanded="true"]')).toHaveCount(1);
  await expect(page.locator(".mark.selected")).toHaveCount(1);
});

test("rejected poses are told with the reason, once they are asked for", async ({ page }) => {
  const { rejected } = await openExample(page);
  const section = page.getByRole("region", { name: "Rejected" });
  await expect(section).toBeHidden();
  await page.getByRole("button", { name: "Rejected" }).click();
  await expect(section).toBeVisible();
  const rows = section.getByRole("button", { name: /score/ });
  const count = await rows.count();
  expect(count).toBeLessThanOrEqual(rejected.length);
  await expect(page.locator(".mark.rejected:visible")).toHaveCount(count);
  const words = rejected.map((pose) => pose.words);
  for (const text of await section.locator(".note").allTextContents()) {
    expect(words).toContain(text.replace(/ \(\d+\)$/, ""));
  }
  await page.keyboard.press("r");
  await expect(section).toBeHidden();
});

test("a score that is asked for leaves the others out", async ({ page }) => {
  const { detections } = await openExample(page);
  const scores = detections.map((detection) => detection.score);
  await page.getByText("Settings").click();
  await page.getByLabel("Lowest score").fill(String(Math.max(...scores)));
  const again = await recognized(page, () =>
    page.getByRole("button", { name: "Recognize" }).click(),
  );
  expect(again.detections.length).toBeLessThanOrEqual(detections.length);
  await expect(foundRows(page)).toHaveCount(again.detections.length);
});

test("a chosen depth image is read with the camera chosen beside it", async ({ page, request }) => {
  const files = await exampleFiles(request);
  await openPage(page);
  const scene = await recognized(page, () => chooseFiles(page, files));
  expect(scene.detections.length).toBeGreaterThan(0);
  await expect(foundRows(page)).toHaveCount(scene.detections.length);
});

test("a scan that is packed by gzip is read as what it is", async ({ page, request }) => {
  const [scan, camera] = await exampleFiles(request);
  const packed = { ...scan, name: `${scan.name}.gz`, buffer: gzipSync(scan.buffer) };
  await openPage(page);
  const scene = await recognized(page, () => chooseFiles(page, [packed, camera]));
  expect(scene.detections.length).toBeGreaterThan(0);
});

test("a depth image without a camera asks for it, and the next one has it", async ({
  page,
  request,
}) => {
  const [scan, camera] = await exampleFiles(request);
  await openPage(page);
  await chooseFiles(page, [scan]);
  await expect(page.getByRole("alert")).toContainText("needs its camera");
  await expect(page.getByLabel("fx")).toBeFocused();
  const numbers = JSON.parse(camera.buffer);
  for (const [key, label] of [
    ["fx", "fx"],
    ["fy", "fy"],
    ["cx", "cx"],
    ["cy", "cy"],
    ["depth_scale", "Depth scale"],
  ]) {
    await page.getByLabel(label, { exact: true }).fill(String(numbers[key]));
  }
  await recognized(page, () => page.getByLabel("Depth scale").press("Enter"));
  await expect(page.getByRole("alert")).toBeEmpty();
  await openPage(page);
  const scene = await recognized(page, () => chooseFiles(page, [scan]));
  expect(scene.detections.length).toBeGreaterThan(0);
});

test("a camera that is dropped by itself is that of the next depth image", async ({
  page,
  request,
}) => {
  const [scan, camera] = await exampleFiles(request);
  await openPage(page);
  await drop(page, [camera]);
  await expect(page.getByRole("alert")).toContainText("kept for the next depth image");
  const scene = await recognized(page, () => drop(page, [scan]));
  expect(scene.detections.length).toBeGreaterThan(0);
});

test("all that a camera file says is sent, or the file is refused", async ({ page, request }) => {
  const [scan, camera] = await exampleFiles(request);
  const saying = (more) => ({
    ...camera,
    buffer: Buffer.from(JSON.stringify({ ...JSON.parse(camera.buffer), ...more })),
  });
  await openPage(page);
  const sent = page.waitForRequest(/v1\/recognize/);
  await recognized(page, () =>
    chooseFiles(page, [scan, saying({ distortion: [0.001, 0, 0, 0, 0] })]),
  );
  expect(new URL((await sent).url()).searchParams.get("distortion")).toBe("0.001,0,0,0,0");
  await chooseFiles(page, [scan, saying({ k1: 0.001 })]);
  await expect(page.getByRole("alert")).toContainText("k1");
});

test("a dropped scan is recognized", async ({ page, request }) => {
  const files = await exampleFiles(request);
  await openPage(page);
  const scene = await recognized(page, () => drop(page, files));
  await expect(foundRows(page)).toHaveCount(scene.detections.length);
  await drawn(page, scene.detections.length);
});

test("a scan that is dropped while another is recognized takes its place", async ({
  page,
  request,
}) => {
  const files = await exampleFiles(request);
  await openPage(page);
  let held = 0;
  await page.route("**/v1/recognize?*", (route) => (held++ ? route.continue() : undefined));
  const canceled = page.waitForEvent("requestfailed", (failed) =>
    failed.url().includes("/v1/recognize"),
  );
  await drop(page, files);
  await expect.poll(() => held).toBe(1);
  const scene = await recognized(page, () =>
    drop(page, [{ ...files[0], name: `second.${files[0].name.split(".")[1]}` }, ...files.slice(1)]),
  );
  expect((await canceled).failure().errorText).toBe("net::ERR_ABORTED");
  await expect(foundRows(page)).toHaveCount(scene.detections.length);
  await expect(page).toHaveTitle(/second/);
  await expect(page.getByRole("alert")).toBeEmpty();
});

for (const clipboard of [true, false]) {
  test(`poses and answers can be copied ${clipboard ? "" : "over plain HTTP"}`, async ({
    page,
    context,
  }) => {
    if (clipboard) await context.grantPermissions(["clipboard-read", "clipboard-write"]);
    else {
      await page.addInitScript(() =>
        Object.defineProperty(Navigator.prototype, "clipboard", { value: undefined }),
      );
    }
    const { detections } = await openExample(page);
    await foundRows(page).first().click();
    await page.getByRole("button", { name: "Copy matrix" }).click();
    await expect(page.getByRole("button", { name: "Copied" })).toBeVisible();
    await page.getByRole("tab", { name: "Models" }).click();
    await page.getByLabel("Filter").press("Control+v");
    const pasted = await page.getByLabel("Filter").inputValue();
    expect(JSON.parse(pasted)).toEqual(detections[0].T_scene_model);
    await page.getByRole("tab", { name: "Result" }).click();
    await page.getByRole("button", { name: "Copy JSON" }).click();
    await expect(page.getByRole("button", { name: "Copied" })).toHaveCount(2);
  });
}

test("the answer can be downloaded as the service gave it", async ({ page }) => {
  const { detections } = await openExample(page);
  const [download] = await Promise.all([
    page.waitForEvent("download"),
    page.getByRole("link", { name: "Download JSON" }).click(),
  ]);
  expect(download.suggestedFilename()).toMatch(/\.trivet\.json$/);
  const stream = await download.createReadStream();
  let text = "";
  for await (const part of stream) text += part;
  expect(JSON.parse(text).scenes[0].detections).toEqual(detections);
});

test("the times add up to the round trip", async ({ page }) => {
  await openExample(page);
  const seconds = (text) => parseFloat(text) * (text.endsWith(" ms") ? 0.001 : 1);
  const stages = (await page.locator(".stages .number").allTextContents()).map(seconds);
  const whole = seconds(await page.locator("#times b").first().textContent());
  expect(stages.length).toBeGreaterThan(3);
  expect(stages.length).toBeLessThanOrEqual(6);
  // Each number is rounded to three figures at worst.
  expect(stages.reduce((sum, value) => sum + value, 0)).toBeGreaterThan(0.9 * whole);
});

/** Several scans that the service keeps, runs over them, and marks. */
import { drop, expect, foundRows, openPage, recognized, test } from "./fixtures.js";

/** The service's examples as files by which a page can be filled. */
async function scanFiles(request) {
  const { examples } = await (await request.get("/v1/examples")).json();
  const files = [];
  for (const [k, example] of examples.slice(0, 2).entries()) {
    const query = new URLSearchParams(example.query);
    const buffer = await (await request.get(example.url)).body();
    files.push({ name: `scan ${k}.${query.get("format")}`, buffer });
    const numbers = query.get("camera").split(",").map(Number);
    const keys = ["fx", "fy", "cx", "cy", "depth_scale"];
    const camera = Object.fromEntries(keys.map((key, i) => [key, numbers[i]]));
    if (!k) files.push({ name: "camera.json", buffer: Buffer.from(JSON.stringify(camera)) });
  }
  return files;
}

const indexOf = async (request) => (await request.get("/v1/session")).json();
const scanRows = (page) => page.locator("#session-scans .scan");

/** Forget all, so that each test starts anew. */
async function clear(request) {
  const { scans } = await indexOf(request);
  for (const { name } of scans) await request.delete(`/v1/session/scans/${name}`);
}

async function keepScans(page, request) {
  await clear(request);
  await openPage(page);
  await drop(page, await scanFiles(request));
  await expect(scanRows(page)).toHaveCount(2);
  await expect(page.locator("#run-progress")).toBeHidden();
}

async function runAll(page, name) {
  await page.getByRole("button", { name: `Run all as ${name}` }).click();
  await expect(page.getByRole("button", { name: "Stop" })).toBeHidden();
}

test("scans are kept with what runs find, and runs are held side by side", async ({
  page,
  request,
}) => {
  await keepScans(page, request);
  await expect(page.getByRole("tab", { name: "Session" })).toHaveAttribute("aria-selected", "true");
  await expect(scanRows(page).locator(".name")).toHaveText(["scan_0", "scan_1"]);
  // Its picture has points.
  await expect
    .poll(() =>
      scanRows(page)
        .first()
        .locator("canvas")
        .evaluate((canvas) => {
          const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
          return data.filter((value, k) => k % 4 === 3 && value > 0).length;
        }),
    )
    .toBeGreaterThan(500);

  await runAll(page, "A");
  await page.locator("#tab-result").click();
  await page.locator("#settings-box > summary").click();
  await page.getByLabel("Lowest score").fill("1");
  await page.keyboard.press("Escape");
  await page.locator("#tab-session").click();
  await runAll(page, "B");
  const { runs } = await indexOf(request);
  expect(runs.map(({ name }) => name)).toEqual(["A", "B"]);
  const found = runs[0].answers.map((answer) => answer.found);
  expect(Math.min(...found)).toBeGreaterThan(0);
  expect(runs[1].answers.map((answer) => answer.found)).toEqual([0, 0]);
  for (const [k, count] of found.entries()) {
    await expect(scanRows(page).nth(k).locator(".run")).toHaveText([`A ${count}`, "B 0"]);
    const cells = page.locator("#comparison tbody tr").nth(k).locator("td");
    await expect(cells.nth(0)).toHaveText("0");
    await expect(cells.nth(1)).toHaveText(`${count}`);
    await expect(cells.nth(2)).toHaveText("0");
  }
  const told = page.locator("#compare-settings");
  await expect(told).toHaveText("Set differently: min-score 0.8 in A, 1 in B.");
  await page.getByLabel("against run").selectOption("A");
  await expect(told).toHaveText("Both were asked with the same settings.");
  const total = page.locator("#comparison tfoot td");
  await expect(total.first()).toHaveText(`${found[0] + found[1]}`);
  await expect(page.locator("#compare-verdict")).toContainText("Mark what is right in the scans");

  // What run B says of a scan, that there is nothing, can be the truth, too.
  await page.getByLabel("Show the answers of run").selectOption("B");
  await scanRows(page).last().click();
  await page.getByRole("button", { name: "Nothing is there" }).click();
  await expect(page.locator("#verdicts-note")).toHaveText("The truth of this scan is kept.");
  expect((await indexOf(request)).scans.map(({ truth }) => truth)).toEqual([null, []]);
  await page.locator("#tab-session").click();
  await page.getByLabel("against run").selectOption("B");
  await expect(page.locator("#compare-verdict")).toHaveText(
    `Of 0 parts marked right in 1 scan, A finds 0 and ${found[1]} that ${found[1] === 1 ? "is" : "are"} not, ` +
      "B finds 0. Both find the same of them.",
  );
});

test("a kept answer comes with what was asked, the camera in its link, too", async ({
  page,
  request,
}) => {
  await keepScans(page, request);
  await page.locator("#tab-result").click();
  await page.locator("#settings-box > summary").click();
  await page.getByLabel("Lowest score").fill("0.9");
  await page.locator("#tab-session").click();
  await runAll(page, "A");
  await page.goto("/");
  await expect(page.locator("#headline")).toHaveText("Ready for a scan");
  await page.locator("#tab-session").click();
  await scanRows(page).first().click();
  await expect(foundRows(page).first()).toBeVisible();
  await expect(page.locator("[name=min-score]")).toHaveValue("0.9");
  await expect(page.locator("#command")).toContainText("scan_0.png");
  await expect(page.locator("#command")).toContainText("--min-score 0.9");
  await expect.poll(() => new URL(page.url()).hash).toContain("camera=");
});

test("depth images without a camera are not kept, and the page says what they need", async ({
  page,
  request,
}) => {
  await clear(request);
  await openPage(page);
  const images = (await scanFiles(request)).filter(({ name }) => name.endsWith("png"));
  await drop(page, images);
  await expect(page.locator("#session-problem")).toContainText("A depth image needs its camera");
  await expect(scanRows(page)).toHaveCount(0);
});

test("what is found is marked by keys and buttons, and becomes the truth", async ({
  page,
  request,
}) => {
  await keepScans(page, request);
  await runAll(page, "A");
  const asked = [];
  page.on("request", (one) => asked.push(one.url()));
  await scanRows(page).first().click();
  await expect(foundRows(page).first()).toBeVisible();
  expect(asked.filter((url) => url.includes("/v1/recognize"))).toEqual([]);
  const count = await foundRows(page).count();
  const right = page.getByRole("button", { name: "Right", exact: true });
  await expect(right).toHaveCount(count);

  const truthOf = async () => (await indexOf(request)).scans[0].truth;
  await foundRows(page).first().click();
  await page.keyboard.press("n");
  await expect(page.getByRole("button", { name: "Wrong" }).first()).toHaveAttribute(
    "aria-pressed",
    "true",
  );
  if (count > 1) expect(await truthOf()).toBeNull();
  await page.keyboard.press("a");
  await expect(page.locator("#verdicts-note")).toContainText(`${count - 1} right, 1 wrong`);
  const answer = await (await request.get("/v1/session/runs/A/scan_0")).json();
  const { detections } = answer.scenes[0];
  expect(detections.map((one) => one.right)).toEqual(detections.map((_, k) => k > 0));
  const poses = (list) => list.map(({ model, T_scene_model }) => ({ model, T_scene_model }));
  const close = (one, other) =>
    one.model === other.model &&
    one.T_scene_model.every((row, i) =>
      row.every((x, k) => Math.abs(x - other.T_scene_model[i][k]) < 1e-5),
    );
  const truth = await truthOf();
  expect(truth).toHaveLength(count - 1);
  for (const pose of poses(detections.slice(1)))
    expect(truth.filter((other) => close(pose, other))).toHaveLength(1);

  await right.first().click();
  await expect(page.locator("#verdicts-note")).toContainText(`${count} right, 0 wrong`);
  expect(await truthOf()).toHaveLength(count);
  // Another run of the same scan is known by that truth.
  await page.keyboard.press("e");
  await runAll(page, "B");
  await page.getByLabel("Show the answers of run").selectOption("B");
  await scanRows(page).first().click();
  await expect(page.locator("#verdicts-note")).toContainText(`${count} right, 0 wrong`);
  // A recognition that is not kept has no marks.
  await page.locator("#settings-box > summary").click();
  await recognized(page, () => page.getByRole("button", { name: "Recognize" }).click());
  await expect(right).toHaveCount(0);
});

test.describe("two tabs that mark one scan", () => {
  test.use({ allowed: /status of 409/ });

  test("lose no mark of each other, and tell that there is another", async ({
    page,
    context,
    request,
  }) => {
    await keepScans(page, request);
    await runAll(page, "A");
    const other = await context.newPage();
    await openPage(other);
    await other.keyboard.press("e");
    for (const tab of [page, other]) {
      await scanRows(tab).first().click();
      await expect(foundRows(tab).first()).toBeVisible();
    }
    const count = await foundRows(page).count();
    expect(count).toBeGreaterThan(1);
    const marks = async () => {
      const { scenes } = await (await request.get("/v1/session/runs/A/scan_0")).json();
      return scenes[0].detections.map(({ right }) => right ?? null);
    };
    const press = (tab, name, k) => tab.getByRole("button", { name, exact: true }).nth(k).click();

    await press(page, "Wrong", 0);
    await expect.poll(marks).toEqual([false, ...Array(count - 1).fill(null)]);
    await press(other, "Right", 1);
    await expect.poll(marks).toEqual([false, true, ...Array(count - 2).fill(null)]);
    await expect(other.locator("#verdicts-note")).toContainText("marked elsewhere meanwhile");
    await expect(other.getByRole("button", { name: "Wrong" }).first()).toHaveAttribute(
      "aria-pressed",
      "true",
    );
    // The truth, too: the first tab tells it, the second one changes it without having seen it.
    await page.locator("#all-right").click();
    await expect(page.locator("#verdicts-note")).toContainText(`${count - 1} right, 1 wrong`);
    await press(other, "Wrong", 1);
    await expect(other.locator("#verdicts-note")).toContainText(`${count - 2} right, 2 wrong`);
    expect(await marks()).toEqual([false, false, ...Array(count - 2).fill(true)]);
    expect((await indexOf(request)).scans[0].truth).toHaveLength(count - 2);
    await other.close();
  });
});

test.describe("what goes wrong", () => {
  test.use({ allowed: /507/ });

  test("a full or stopped session says so", async ({ page, request }) => {
    await keepScans(page, request);
    await page.route("**/v1/session/runs/**", (route) =>
      route.fulfill({ status: 507, json: { error: "the session is full" } }),
    );
    await page.getByRole("button", { name: /Run all/ }).click();
    await expect(page.locator("#session-problem")).toContainText("scan_0: the session is full");
    await page.unroute("**/v1/session/runs/**");
    await page.route("**/v1/recognize?**", () => {}); // never answers
    await page.getByRole("button", { name: /Run all/ }).click();
    await page.getByRole("button", { name: "Stop" }).click();
    await expect(page.getByRole("button", { name: /Run all/ })).toBeEnabled();
    await expect(page.locator("#session-problem")).toBeEmpty();
    expect((await indexOf(request)).runs).toEqual([]);
  });
});

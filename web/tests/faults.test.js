/** What goes wrong is said, and the page goes on. */
import { kRestMs } from "../src/pulse.js";
import { kQuickMs } from "../src/service.js";
import {
  atRest,
  chooseFiles,
  drop,
  exampleFiles,
  expect,
  foundRows,
  openExample,
  openPage,
  recognized,
  test,
} from "./fixtures.js";

const file = (name, text) => ({
  name,
  mimeType: "application/octet-stream",
  buffer: Buffer.from(text),
});

test.describe("a service that refuses", () => {
  test.use({ allowed: /status of 400/ });

  test("tells why a broken file cannot be read, and takes the next one", async ({
    page,
    request,
  }) => {
    await openPage(page);
    await chooseFiles(page, [file("broken.ply", "this is no ply")]);
    await expect(page.getByRole("alert")).toContainText("expected");
    await expect(page.locator("#headline")).toHaveText("Not recognized");
    await expect(page.getByRole("alert").getByRole("button")).toHaveCount(0);
    const files = await exampleFiles(request);
    const scene = await recognized(page, () => chooseFiles(page, files));
    await expect(page.getByRole("alert")).toBeEmpty();
    await expect(foundRows(page)).toHaveCount(scene.detections.length);
  });
});

test.describe("a service that is gone", () => {
  test.use({ allowed: /net::ERR_FAILED/ });

  test("is said to be, and asked again on demand", async ({ page }) => {
    await openPage(page);
    await page.route("**/v1/recognize?*", (route) => route.abort());
    await page.locator("#examples button").first().click();
    await expect(page.getByRole("alert")).toContainText("The service does not answer");
    await page.unroute("**/v1/recognize?*");
    const scene = await recognized(page, () =>
      page.getByRole("button", { name: "Try again" }).click(),
    );
    await expect(foundRows(page)).toHaveCount(scene.detections.length);
  });
});

test.describe("a service that falls silent", () => {
  test.use({ allowed: /net::ERR_|status of 503/ });

  test("is said to within two seconds, and no more once it answers", async ({ page }) => {
    expect(kRestMs + kQuickMs).toBeLessThan(2000);
    await openPage(page);
    const banner = page.locator("#away");
    await expect(banner).toBeHidden();
    const kHealth = "**/v2/health/live";
    for (const silence of [() => {}, (route) => route.abort()]) {
      await page.route(kHealth, silence);
      await expect(banner).toBeVisible({ timeout: 20_000 });
      await expect(banner).toContainText("The service does not answer");
      const [again] = await Promise.all([
        page.waitForRequest(kHealth),
        banner.getByRole("button", { name: "Try again" }).click(),
      ]);
      expect(again.method()).toBe("GET");
      await expect(banner).toBeVisible();
      await page.unroute(kHealth);
      await expect(banner).toBeHidden();
    }
    // Whoever refuses is there.
    await page.route(kHealth, (route) => route.fulfill({ status: 503, json: {} }));
    await page.waitForResponse(kHealth);
    await page.waitForResponse(kHealth);
    await expect(banner).toBeHidden();
  });
});

test.describe("a service that is full", () => {
  test.use({ allowed: /status of 503/ });

  test("is said to be busy, with the wait that it asks for", async ({ page }) => {
    await openPage(page);
    await page.route("**/v1/recognize?*", (route) =>
      route.fulfill({
        status: 503,
        headers: { "Retry-After": "1" },
        json: { error: "as many requests wait as may" },
      }),
    );
    await page.locator("#examples button").first().click();
    await expect(page.getByRole("alert")).toContainText(
      "The service is busy: as many requests wait as may. Try again in 1 s.",
    );
  });
});

test.describe("a scan in another unit", () => {
  test.use({ allowed: /status of 4\d\d/ });

  test("is told to be, in Settings, and read in the one that fits", async ({ page, request }) => {
    const { unit } = await (await request.get("/v1/models")).json();
    const other = { m: "mm", mm: "m" }[unit];
    await page.addInitScript(
      (wrong) => localStorage.setItem("trivet.settings", JSON.stringify({ unit: wrong })),
      other,
    );
    await openPage(page);
    await chooseFiles(page, await exampleFiles(request));
    await expect(page.getByRole("alert")).toContainText(
      new RegExp(`fits to them if its unit is ${unit}: [\\d.]+ ${unit} across`),
    );
    await expect(page.locator("#settings-box")).toHaveAttribute("open", "");
    await expect(page.getByLabel("Unit of the scan")).toBeFocused();
    const scene = await recognized(page, () =>
      page.getByRole("button", { name: `Read it in ${unit}` }).click(),
    );
    await expect(page.getByRole("alert")).toBeEmpty();
    await expect(foundRows(page)).toHaveCount(scene.detections.length);
  });
});

test("files that are no scans are refused with what was expected", async ({ page }) => {
  await page.route("**/v1/session", (route) => route.fulfill({ json: { kept: false } }));
  await openPage(page);
  await expect(page.getByRole("tab", { name: "Session" })).toBeHidden();
  await drop(page, [file("scan.jpg", "II")]);
  await expect(page.getByRole("alert")).toContainText("scan.jpg: expected a scan (ply, pcd");
  await drop(page, [file("a.ply", ""), file("b.ply", "")]);
  await expect(page.getByRole("alert")).toContainText("Expected one scan, found 2");
  await drop(page, [file("hand_eye.json", "[[1, 0, 0, 0]]")]);
  await expect(page.getByRole("alert")).toContainText('under "For a robot"');
  await drop(page, [file("camera.json", '{"fx": 1}')]);
  await expect(page.getByRole("alert")).toContainText("missing: fy, cx, cy, depth_scale");
});

test("a scan with nothing in it says what to check", async ({ page }) => {
  await openPage(page);
  const plane = Array.from(
    { length: 900 },
    (_, i) => `${(i % 30) / 100} ${Math.floor(i / 30) / 100} 1`,
  );
  await recognized(page, () => chooseFiles(page, [file("plane.xyz", plane.join("\n"))]));
  await expect(page.locator("#headline")).toHaveText("No model found");
  await expect(page.locator("#advice")).toContainText("290 mm × 290 mm × 0 mm");
});

test.describe("a browser without WebGL", () => {
  test.use({ allowed: /WebGL/ });

  test("lists what was found", async ({ page }) => {
    await page.addInitScript(() => {
      HTMLCanvasElement.prototype.getContext = () => null;
    });
    await openPage(page);
    await expect(page.getByText("No 3-D view")).toBeVisible();
    const scene = await recognized(page, () => page.locator("#examples button").first().click());
    await expect(foundRows(page)).toHaveCount(scene.detections.length);
  });
});

test("without anything to do, nothing is drawn", async ({ page }) => {
  await page.addInitScript(() => {
    window.frames_asked = 0;
    const ask = window.requestAnimationFrame;
    window.requestAnimationFrame = (run) => {
      window.frames_asked += 1;
      return ask.call(window, run);
    };
  });
  await openExample(page);
  const asked = () => page.evaluate(() => window.frames_asked);
  await expect
    .poll(async () => {
      await atRest(page);
      const before = await asked();
      await page.waitForTimeout(500);
      return (await asked()) - before;
    })
    .toBe(0);
  await page.keyboard.press("f");
  await expect.poll(asked).toBeGreaterThan(0);
});

test("what a scan had on the GPU is freed for the next one", async ({ page }) => {
  await page.addInitScript(() => {
    window.live = 0;
    const gl = WebGL2RenderingContext.prototype;
    for (const kind of ["Buffer", "Texture", "Program", "VertexArray", "Framebuffer"]) {
      const { [`create${kind}`]: create, [`delete${kind}`]: remove } = gl;
      gl[`create${kind}`] = function () {
        window.live += 1;
        return create.call(this);
      };
      gl[`delete${kind}`] = function (thing) {
        if (thing) window.live -= 1;
        return remove.call(this, thing);
      };
    }
  });
  await openExample(page);
  await page.keyboard.press("r");
  const live = () => page.evaluate(() => window.live);
  const again = async () => {
    await page.getByText("Examples").click();
    await recognized(page, () => page.locator("#examples button").first().click());
    await foundRows(page).first().click();
    await expect(page.locator(".mark.selected")).toHaveCount(1);
    await atRest(page);
    return live();
  };
  await again();
  const first = await again();
  const second = await again();
  expect(first).toBeGreaterThan(10);
  expect(second).toBeLessThanOrEqual(first);
});

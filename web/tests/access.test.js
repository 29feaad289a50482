/** Who may ask the service: its own page, with a token where it wants one; no page elsewhere. */
import { spawn } from "node:child_process";
import { once } from "node:events";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { expect, test } from "@playwright/test";
import { addressOf } from "./service.js";

const kToken = "a-token-of-the-cell";
let service, url;

test.beforeAll(async () => {
  const { TRIVET_PROGRAM, TRIVET_FOLDER } = process.env;
  test.skip(!TRIVET_PROGRAM, "no program to start");
  writeFileSync(join(TRIVET_FOLDER, "tokens"), `${kToken}\n`, { mode: 0o600 });
  const words = ["--port", "0", "--token-file", "tokens", "--examples", "scans/manifest.json"];
  service = spawn(TRIVET_PROGRAM, ["serve", "l.h5", "--drain-grace-ms", "0", ...words], {
    cwd: TRIVET_FOLDER,
    stdio: ["ignore", "ignore", "pipe"],
  });
  url = await addressOf(service);
  service.stderr.resume();
});

test.afterAll(async () => {
  if (!service) return;
  const ended = once(service, "exit");
  service.kill("SIGTERM");
  await ended;
});

test("the page asks for a token once, and shows it with all that it asks", async ({ page }) => {
  const given = ["a-wrong-one", kToken];
  const asked = [];
  page.on("dialog", (dialog) => {
    asked.push(dialog.message());
    dialog.accept(given.shift());
  });
  await page.goto(url);
  await expect(page.locator("#headline")).toHaveText("Ready for a scan");
  expect(asked).toEqual(Array(2).fill("The service asks for a token:"));
  await page.locator("#examples").getByRole("button").first().click();
  await expect(page.getByRole("heading", { name: "Time" })).toBeVisible();
  await page.keyboard.press("m");
  const picture = page.locator("#models img").first();
  await expect(async () => {
    expect(await picture.evaluate((image) => image.naturalWidth)).toBeGreaterThan(0);
  }).toPass();
  await page.reload();
  await expect(page.locator("#headline")).not.toHaveText("");
  expect(asked).toHaveLength(2);
});

test("a page elsewhere changes nothing", async ({ page, request }) => {
  const address = process.env.TRIVET_URL;
  const reloads = async () =>
    (await (await request.get(`${address}/metrics`)).text()).match(/trivet_reload_total.*/g);
  const before = await reloads();
  await page.route("http://elsewhere.example/", (route) =>
    route.fulfill({ contentType: "text/html", body: "<p>elsewhere</p>" }),
  );
  await page.goto("http://elsewhere.example/");
  const outcomes = await page.evaluate(
    (target) =>
      Promise.all(
        [
          { method: "POST", mode: "no-cors" },
          { method: "POST", headers: { "X-Trivet": "page" } },
          { method: "PUT" },
        ].map((options) =>
          fetch(target, options).then(
            (response) => response.type,
            (error) => error.name,
          ),
        ),
      ),
    `${address}/v1/library/reload`,
  );
  expect(outcomes.slice(1)).toEqual(["TypeError", "TypeError"]);
  expect(await reloads()).toEqual(before);
});

/** Pages that the program writes, as a browser shows them. */
import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

import { expect, test } from "@playwright/test";

const kStudy = `
[models.parts]
parts = 2

[scenes.piles]
models = ["parts"]
set = { scan.scenes = 1, scan.instances = 2, scan.sensor = "laser" }

[[experiments]]
name = "noise"
scenes = ["piles"]
methods = ["ppf"]
vary = "degrade.noise"
values = [0, 2]
`;

let folder;
test.beforeAll(() => {
  folder = mkdtempSync(join(tmpdir(), "trivet-reports-"));
  const run = (...words) =>
    execFileSync(process.env.TRIVET_PROGRAM, words, { cwd: folder, stdio: "pipe" });
  run("scan", "--parts", "2", "-o", "scans", "--scenes", "1", "--instances", "3");
  run("train", "scans/manifest.json", "--methods", "ppf", "-o", "l.h5");
  run("recognize", "l.h5", "scans/manifest.json", "--report", "recognized");
  run("evaluate", "l.h5", "scans/manifest.json", "--report", "evaluated");
  writeFileSync(join(folder, "study.toml"), kStudy);
  run("study", "study.toml", "-o", "studied");
});
test.afterAll(() => rmSync(folder, { recursive: true }));

const open = (page, name) => page.goto(pathToFileURL(join(folder, name, "index.html")).href);

for (const name of ["recognized", "evaluated", "studied"]) {
  test(`nothing of the page '${name}' is wider than a phone`, async ({ page }) => {
    await page.setViewportSize({ width: 390, height: 844 });
    await open(page, name);
    expect(await page.evaluate(() => document.scrollingElement.scrollWidth)).toBe(390);
  });
}

test("a view is one picture, whose layers are picked by mouse or keys", async ({ page }) => {
  await open(page, "recognized");
  const view = page.locator(".layers").first();
  const shown = view.locator(".view:visible img");
  await expect(shown).toHaveCount(1);
  await expect(shown).toHaveAttribute("alt", /found$/);
  await view.getByText("Scan").click();
  await expect(shown).toHaveCount(1);
  await expect(shown).toHaveAttribute("alt", /scan$/);
  await page.keyboard.press("ArrowRight");
  await expect(shown).toHaveAttribute("alt", /found$/);
});

test("charts of a study fill their cards", async ({ page }) => {
  await open(page, "studied");
  const cards = page.locator(".charts > .table");
  await expect(cards).toHaveCount(2);
  for (const card of await cards.all()) {
    const room = await card.evaluate((box) => {
      const { paddingLeft, paddingRight } = getComputedStyle(box);
      return box.clientWidth - parseFloat(paddingLeft) - parseFloat(paddingRight);
    });
    expect((await card.locator("svg").boundingBox()).width).toBeGreaterThan(0.98 * room);
    await expect(card.locator("h4")).not.toBeEmpty();
  }
});

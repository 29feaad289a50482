/** Scans that come into a watched folder, as they come. */
import { copyFileSync, readFileSync } from "node:fs";
import { join } from "node:path";

import { drawn, expect, openPage, test } from "./fixtures.js";

test("a scan is shown as it comes, and an older one when it is picked", async ({ page }) => {
  const folder = process.env.TRIVET_FOLDER;
  test.skip(!folder, "the service was started elsewhere");
  const { scenes } = JSON.parse(readFileSync(join(folder, "scans/manifest.json")));
  const drop = (scene, name) =>
    copyFileSync(join(folder, "scans", scenes[scene].file), join(folder, "live", name));
  await openPage(page);
  const strip = page.getByRole("region", { name: "Live scans" }).getByRole("listitem");
  drop(0, "one.png");
  await expect(page.locator("#view-title")).toHaveText("one.png");
  const count = async (row) => Number(await row.locator(".count").textContent());
  await expect(strip).toHaveCount(1);
  await drawn(page, await count(strip.first()));
  drop(1, "two.png");
  await expect(page.locator("#view-title")).toHaveText("two.png");
  await drawn(page, await count(strip.last()));
  // A picked one stays, whatever comes.
  await strip.first().getByRole("button").click();
  await expect(page.locator("#view-title")).toHaveText("one.png");
  drop(1, "three.png");
  await expect(strip).toHaveCount(3);
  await expect(page.locator("#view-title")).toHaveText("one.png");
  await page.keyboard.press("v");
  await expect(page.locator("#view-title")).toHaveText("three.png");
});

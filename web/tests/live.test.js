/** Scans that come into a watched folder, as they come. */
import { copyFileSync, readFileSync } from "node:fs";
import { join } from "node:path";

import { drawn, expect, foundRows, openPage, test } from "./fixtures.js";

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

test.describe("a service that the test plays", () => {
  /** Scans as /v1/live tells them, of an example and its answer; `change(live)` is what comes next. */
  async function play(page, request) {
    const { examples } = await (await request.get("/v1/examples")).json();
    const [{ query, url }] = examples;
    const asked = await request.post(`/v1/recognize?${query}`, {
      data: await (await request.get(url)).body(),
    });
    const answer = await asked.json();
    const count = answer.scenes[0].detections.length;
    const live = { epoch: "first", scans: [], afters: [] };
    await page.route("**/v1/live?*", (route) => {
      const after = Number(new URL(route.request().url()).searchParams.get("after"));
      live.afters.push(`${live.epoch} ${after}`);
      const scans = live.scans.filter(({ number }) => number > after);
      return route.fulfill({ json: { watched: true, epoch: live.epoch, scans } });
    });
    await page.route("**/v1/live/*/answer", (route) => route.fulfill({ json: answer }));
    live.add = (number, name, error = null) =>
      live.scans.push({
        number,
        name,
        query,
        time: 0,
        seconds: error ? null : 0.5,
        detections: error ? null : count,
        error,
        url,
        answer: `/v1/live/${number}/answer`,
      });
    return { live, count };
  }
  const strip = (page) => page.getByRole("region", { name: "Live scans" }).getByRole("listitem");

  test("counts anew after a restart, and its scans are shown all the same", async ({
    page,
    request,
  }) => {
    const { live, count } = await play(page, request);
    live.add(41, "before.png");
    await openPage(page);
    live.add(42, "last.png");
    await expect(page.locator("#view-title")).toHaveText("last.png");
    Object.assign(live, { epoch: "second", scans: [] });
    live.add(1, "after.png");
    await expect(page.locator("#view-title")).toHaveText("after.png");
    await expect(strip(page)).toHaveCount(1);
    await drawn(page, count);
    live.add(2, "next.png");
    await expect(page.locator("#view-title")).toHaveText("next.png");
    await expect(strip(page)).toHaveCount(2);
    expect(live.afters).toContain("second 42");
    expect(live.afters).toContain("second 0");
  });

  test("fails at a scan, and nothing of the one before stays", async ({ page, request }) => {
    const { live, count } = await play(page, request);
    await openPage(page);
    live.add(1, "good.png");
    await drawn(page, count);
    await expect(foundRows(page)).toHaveCount(count);
    live.add(2, "cut.png", "cut.png, byte 7: expected a PNG file");
    await expect(page.locator("#view-title")).toHaveText("cut.png");
    await expect(page.locator("#headline")).toHaveText("Not recognized");
    await expect(page.locator("#problem")).toContainText("cut.png, byte 7: expected a PNG file");
    await expect(foundRows(page)).toHaveCount(0);
    await expect(page.locator(".mark.found")).toHaveCount(0);
    await expect(page.getByRole("heading", { name: "Time" })).toBeHidden();
    live.add(3, "better.png");
    await expect(foundRows(page)).toHaveCount(count);
    await expect(page.locator("#problem")).toBeEmpty();
    // A failed one is a result to go back to.
    await strip(page).nth(1).getByRole("button").click();
    await expect(page.locator("#problem")).toContainText("cut.png, byte 7");
    await expect(foundRows(page)).toHaveCount(0);
  });
});

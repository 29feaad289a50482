/** A service that ends without notice and starts again while a page shows what it watches. */
import { spawn } from "node:child_process";
import { once } from "node:events";
import { copyFileSync, mkdirSync, readFileSync } from "node:fs";
import { join } from "node:path";

import { drawn, expect, test } from "./fixtures.js";
import { addressOf } from "./service.js";

const { TRIVET_PROGRAM: program, TRIVET_FOLDER: folder } = process.env;
let service;

/** Start the service at a port, 0 for any that is free; returns its address. */
async function start(manifest, port) {
  const { camera } = manifest.scenes[0];
  const numbers = ["fx", "fy", "cx", "cy", "depth_scale"].map((key) => camera[key]);
  const watched = ["--watch", "watched", "--watch-query", `method=ppf&camera=${numbers}`];
  service = spawn(program, ["serve", "l.h5", "--port", port, ...watched], {
    cwd: folder,
    stdio: ["ignore", "ignore", "pipe"],
  });
  const address = await addressOf(service);
  service.stderr.resume();
  return address;
}

async function kill() {
  const ended = once(service, "exit");
  service.kill("SIGKILL");
  await ended;
  service = undefined;
}

test.use({
  allowed: /ERR_CONNECTION_(REFUSED|RESET)|ERR_EMPTY_RESPONSE|ERR_INCOMPLETE_CHUNKED/, // meanwhile
  baseURL: async ({}, use) => {
    test.skip(!program || !folder, "no program to start");
    const manifest = JSON.parse(readFileSync(join(folder, "scans/manifest.json")));
    mkdirSync(join(folder, "watched"), { recursive: true });
    const address = await start(manifest, "0");
    await use(address);
    if (service) await kill();
  },
});

test("scans after a restart are shown by the page that was open before", async ({
  page,
  baseURL,
}) => {
  const manifest = JSON.parse(readFileSync(join(folder, "scans/manifest.json")));
  const drop = (scene, name) =>
    copyFileSync(join(folder, "scans", manifest.scenes[scene].file), join(folder, "watched", name));
  const strip = page.getByRole("region", { name: "Live scans" }).getByRole("listitem");
  const title = page.locator("#view-title");
  const away = page.locator("#away");
  await page.goto("/");
  await expect(page.locator("#headline")).toHaveText("Ready for a scan");
  for (const name of ["one.png", "two.png"]) {
    drop(0, name);
    await expect(title).toHaveText(name);
  }
  await expect(strip).toHaveCount(2);

  await kill();
  await expect(away).toBeVisible();
  await expect(title).toHaveText("two.png");
  expect(await start(manifest, new URL(baseURL).port)).toBe(baseURL);
  await expect(away).toBeHidden();

  drop(1, "after.png");
  await expect(title).toHaveText("after.png");
  await expect(strip).toHaveCount(1); // the others are unknown to the service that runs now
  await drawn(page, Number(await strip.locator(".count").textContent()));
  drop(0, "next.png");
  await expect(title).toHaveText("next.png");
  await expect(strip).toHaveCount(2);
  // A picked one is fetched from the service that has it.
  await strip.first().getByRole("button").click();
  await expect(title).toHaveText("after.png");
});

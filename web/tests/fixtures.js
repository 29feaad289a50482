import { test as base } from "@playwright/test";

export { expect } from "@playwright/test";

/**
 * Tests of a page that is watched: no error in its console (which tells of broken content security
 * policies, too) but those that `allowed` matches, and no request to another origin.
 */
export const test = base.extend({
  allowed: [null, { option: true }],
  baseURL: async ({}, use) => use(process.env.TRIVET_URL),
  page: async ({ page, baseURL, allowed }, use) => {
    const wrong = [];
    page.on("console", (message) => {
      if (message.type() === "error" && !allowed?.test(message.text())) wrong.push(message.text());
    });
    page.on("pageerror", (error) => wrong.push(error.message));
    page.on("dialog", (dialog) => dialog.accept());
    page.on("request", (request) => {
      const url = request.url();
      if (!url.startsWith(`${baseURL}/`) && !url.startsWith("blob:")) wrong.push(`asked ${url}`);
    });
    await use(page);
    base.expect(wrong).toEqual([]);
  },
});

/** Open the page and wait until it takes scans. */
export async function openPage(page) {
  await page.goto("/");
  await base.expect(page.locator("#headline")).toHaveText("Ready for a scan");
}

const isRecognition = (response) => response.url().includes("/v1/recognize");

/** Do something that makes the page recognize; returns the scene of the service's answer. */
export async function recognized(page, act) {
  const [response] = await Promise.all([page.waitForResponse(isRecognition), act()]);
  const { scenes } = await response.json();
  await base.expect(page.getByRole("heading", { name: "Time" })).toBeVisible();
  return scenes[0];
}

/** Open the page with one of the service's examples; returns the scene of the answer. */
export async function openExample(page, index = 0) {
  await openPage(page);
  const example = page.locator("#examples").getByRole("button").nth(index);
  const scene = await recognized(page, () => example.click());
  await drawn(page, scene.detections.length);
  return scene;
}

/** Wait until the view shows this many detections. */
export async function drawn(page, count) {
  const marks = page.locator(".mark.found");
  await base.expect(marks).toHaveCount(count);
  if (count) await base.expect(marks.first()).toBeVisible();
  await atRest(page);
}

export const foundRows = (page) =>
  page.getByRole("region", { name: "Found" }).getByRole("button", { name: /score/ });

/** The first example as files: its scan, and its camera if it is a depth image. */
export async function exampleFiles(request) {
  const { examples } = await (await request.get("/v1/examples")).json();
  const [example] = examples;
  const buffer = await (await request.get(example.url)).body();
  const parameters = new URLSearchParams(example.query);
  const name = `scan.${parameters.get("format")}`;
  const files = [{ name, mimeType: "application/octet-stream", buffer }];
  const numbers = parameters.get("camera")?.split(",").map(Number);
  if (numbers) {
    const keys = ["fx", "fy", "cx", "cy", "depth_scale"];
    const camera = Object.fromEntries(keys.map((key, k) => [key, numbers[k] ?? 1]));
    files.push({
      name: "camera.json",
      mimeType: "application/json",
      buffer: Buffer.from(JSON.stringify(camera)),
    });
  }
  return files;
}

/** Drop files onto the page. */
export async function drop(page, files) {
  const contents = files.map(({ name, buffer }) => ({ name, base64: buffer.toString("base64") }));
  const transfer = await page.evaluateHandle((all) => {
    const made = new DataTransfer();
    for (const { name, base64 } of all) {
      const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
      made.items.add(new File([bytes], name));
    }
    return made;
  }, contents);
  await page.dispatchEvent("body", "dragover", { dataTransfer: transfer });
  await page.dispatchEvent("body", "drop", { dataTransfer: transfer });
}

export const chooseFiles = (page, files) => page.getByLabel("Scan file").setInputFiles(files);

/** Where the view looks: x, y, z in the scan's unit. */
export async function lookedAt(page) {
  const text = await page.locator("#look").textContent();
  return text
    .match(/−?[\d.]+/g)
    .slice(0, 3)
    .map((number) => Number(number.replace("−", "-")));
}

/** To run in the page: the pixels of a PNG. */
const decode = `async (base64) => {
  const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  const image = await createImageBitmap(new Blob([bytes]));
  const context = new OffscreenCanvas(image.width, image.height).getContext("2d");
  context.drawImage(image, 0, 0);
  return context.getImageData(0, 0, image.width, image.height).data;
}`;

/** The pixels of a rectangle of the page: [r, g, b, a, r, …], row by row. */
export async function pixels(page, clip) {
  const png = (await page.screenshot({ clip })).toString("base64");
  return page.evaluate(`(${decode})("${png}").then((data) => [...data])`);
}

/** Wait until all that was asked of the view is drawn, and its labels are placed. */
export const atRest = (page) =>
  base.expect(page.getByRole("application")).toHaveAttribute("aria-busy", "false");

/** What the view looks like, at rest. */
export async function look(page) {
  await atRest(page);
  return (await page.getByRole("application").screenshot()).toString("base64");
}

/** The share of pixels that differ visibly between an earlier look of the view and this one. */
export async function changed(page, before) {
  const pictures = [before, await look(page)].map((png) => `(${decode})("${png}")`);
  return page.evaluate(`Promise.all([${pictures}]).then(([a, b]) => {
    let count = 0;
    for (let i = 0; i < a.length; i += 4) count += Math.abs(a[i + 1] - b[i + 1]) > 16;
    return (4 * count) / a.length;
  })`);
}

/** Deviations, sections, lengths and colors of a scan. */
import { PLYLoader } from "three/examples/jsm/loaders/PLYLoader.js";

import { findDistances, Surface } from "../src/measure/signed_distance.js";
import { kPalettes } from "../src/view/palettes.js";
import {
  atRest,
  changed,
  expect,
  foundRows,
  look,
  openExample,
  pixels,
  recognized,
  test,
} from "./fixtures.js";
import { kSights, seen } from "./sight.js";

const number = (text) => Number(text.replace("−", "-").match(/-?[\d.]+/)[0]);
const millimeters = (text) => number(text) * (/ m\b/.test(text) ? 1000 : 1);
const value = (page, box, term) =>
  page.locator(`${box} dl > div`).filter({ hasText: term }).locator("dd").textContent();

/** Open an example and Measure; returns { scene, positions: of its points [m] }. */
async function openMeasure(page) {
  const answered = page.waitForResponse((response) => response.url().includes("/v1/points"));
  const scene = await openExample(page);
  const response = await answered;
  expect(response.headers()["x-offset"] ?? "0,0,0").toBe("0,0,0");
  expect(response.headers()["x-columns"]).toBe(undefined);
  const positions = new Float32Array(new Uint8Array(await response.body()).buffer);
  await page.locator("#measure-box > summary").click();
  return { scene, positions };
}

async function meshOf(request, name) {
  const { models } = await (await request.get("/v1/models")).json();
  const bytes = await (await request.get(models.find((model) => model.name === name).mesh)).body();
  return new PLYLoader().parse(new Uint8Array(bytes).buffer);
}

/** Distances within a band of a detection, in mm. */
async function distancesTo(request, detection, positions, band) {
  const mesh = await meshOf(request, detection.model);
  const surface = new Surface(mesh.getAttribute("position").array, mesh.getIndex().array);
  const rows = detection.T_scene_model;
  const pose = [0, 1, 2, 3].flatMap((column) => rows.map((row) => row[column]));
  const out = new Float64Array(positions.length / 3);
  findDistances(positions, [{ surface, pose }], band / 1000, out);
  return [...out].filter((distance) => distance === distance).map((distance) => 1000 * distance);
}

test("the scan is measured against what is selected, and then against all", async ({
  page,
  request,
}) => {
  const { scene, positions } = await openMeasure(page);
  await page.getByLabel("Color of the scan").selectOption("distance");
  await page.getByRole("spinbutton", { name: "Tolerance ±" }).fill("0.05");
  await page.getByLabel("Points within").fill("2");
  await page.getByLabel("Points within").press("Tab");
  await foundRows(page).nth(1).click();
  const told = async (term) => value(page, "#distances", term);
  const check = async (wanted) => {
    await expect(page.locator("#distances dl")).toContainText(
      `${wanted.length.toLocaleString("en")} of`,
    );
    const rms = Math.hypot(...wanted) / Math.sqrt(wanted.length);
    expect(number(await told("rms"))).toBeCloseTo(Number(rms.toPrecision(3)), 6);
    const mean = wanted.reduce((a, b) => a + b) / wanted.length;
    expect(Math.abs(number(await told("mean")) - mean)).toBeLessThan(1e-2 * rms);
    const magnitudes = wanted.map(Math.abs).sort((a, b) => a - b);
    const p95 = number(await told("95 %"));
    const share = magnitudes.filter((magnitude) => magnitude <= p95).length / wanted.length;
    expect(share).toBeCloseTo(0.95, 2);
    const within = magnitudes.filter((magnitude) => magnitude <= 0.05).length / wanted.length;
    expect(number(await told("in tolerance"))).toBe(Math.round(100 * within));
    const bars = await page
      .locator(".histogram rect")
      .evaluateAll((all) => all.map((bar) => Number(bar.getAttribute("height"))));
    const counts = bars.map((_, k) => {
      const [low, high] = [k, k + 1].map((edge) => (4 * edge) / bars.length - 2);
      return wanted.filter((distance) => distance >= low && distance < high).length;
    });
    const tallest = Math.max(...bars);
    bars.forEach((bar, k) =>
      expect(Math.abs(bar / tallest - counts[k] / Math.max(...counts))).toBeLessThan(0.01),
    );
  };
  const all = [];
  for (const detection of scene.detections) {
    all.push(await distancesTo(request, detection, positions, 2));
  }
  expect(all[1].length).toBeGreaterThan(100);
  await check(all[1]);

  await page.getByRole("combobox", { name: "To", exact: true }).selectOption("all");
  const most = all.flat().length; // those near to two count once
  const count = async () => number((await told("points")).replaceAll(",", ""));
  await expect.poll(count).toBeGreaterThan(all[1].length);
  expect(await count()).toBeLessThanOrEqual(most);
});

test("what is out of tolerance has colors of its own, and the legend tells the limits", async ({
  page,
}) => {
  await openMeasure(page);
  await page.getByLabel("Color of the scan").selectOption("distance");
  const mark = await page.locator(".mark.found").first().boundingBox();
  const clip = { x: mark.x - 30, y: mark.y - 30, width: mark.width + 60, height: mark.height + 60 };
  const near = async (colors) => {
    const data = await pixels(page, clip);
    let count = 0;
    for (let i = 0; i < data.length; i += 4) {
      const rgb = data.slice(i, i + 3);
      count += colors.some((color) => {
        const [light, full] = [rgb, color].map((all) => all.reduce((sum, x) => sum + x));
        const share = light / full;
        return rgb.every((x, k) => Math.abs(x - share * color[k]) < 25) && share > 0.5;
      });
    }
    return count;
  };
  const { below, above } = kPalettes.deviation;
  await expect(page.locator(".histogram")).toBeVisible();
  expect(await near([below, above])).toBeLessThan(60);
  await page.getByRole("spinbutton", { name: "Tolerance ±" }).fill("0.0001");
  await page.getByLabel("Points within").fill("2");
  await page.getByLabel("Points within").press("Tab");
  await expect(page.locator("#legend")).toContainText("+0.0001 mm");
  await expect.poll(() => near([below, above])).toBeGreaterThan(300);
  await page.getByRole("spinbutton", { name: "Tolerance ±" }).fill("-1");
  await page.getByRole("spinbutton", { name: "Tolerance ±" }).press("Tab");
  await expect(page.locator("#distances")).toContainText(
    "Tolerance: expected a length above 0 mm, found -1 mm.",
  );
  await page.getByLabel("Color of the scan").selectOption("plain");
  await expect(page.locator("#legend")).toBeHidden();
});

test("a scan that has intensities is colored by them, others are not", async ({ page }) => {
  await openMeasure(page);
  const color = page.getByLabel("Color of the scan");
  await expect(color.locator("[value=intensity]")).toHaveAttribute("disabled", "");
  const rows = Array.from({ length: 4096 }, (_, k) => {
    const [x, y] = [k % 64, Math.floor(k / 64)];
    return `${x / 1000} ${y / 1000} 0.5 ${x < 32 ? 120 : 380}`;
  });
  const buffer = Buffer.from(rows.join("\n"));
  await recognized(page, () =>
    page.locator("#files").setInputFiles({ name: "lit.xyz", mimeType: "text/plain", buffer }),
  );
  await color.selectOption("intensity");
  await expect(page.locator("#legend")).toContainText("intensity");
  for (const label of ["120", "250", "380"])
    await expect(page.locator("#legend")).toContainText(label);
});

test("heights and distances from the sensor are told in the legend", async ({ page }) => {
  const { positions } = await openMeasure(page);
  const limits = async (valueAt) => {
    const values = Array.from({ length: positions.length / 3 }, (_, i) =>
      valueAt(...positions.slice(3 * i, 3 * i + 3)),
    ).sort((a, b) => a - b);
    const spread = values.at(-1) - values[0];
    const labels = await page.locator("#legend .labels > span").allTextContents();
    [0.01, 0.99].forEach((share, k) => {
      const wanted = values[Math.round(share * (values.length - 1))];
      expect(Math.abs(millimeters(labels[2 * k]) / 1000 - wanted)).toBeLessThan(0.01 * spread);
    });
  };
  const color = page.getByLabel("Color of the scan");
  const before = await look(page);
  await color.selectOption("height");
  await expect(page.getByRole("combobox", { name: "Up" })).toHaveValue("-y"); // of a camera
  await limits((x, y) => -y);
  await page.getByRole("combobox", { name: "Up" }).selectOption("+x");
  await limits((x) => x);
  await color.selectOption("range");
  await limits((x, y, z) => Math.hypot(x, y, z));
  expect(await changed(page, before)).toBeGreaterThan(0.1);
});

test("a ruler measures between points of the scan, by pointer and by keys", async ({ page }) => {
  const { positions } = await openMeasure(page);
  const box = await page.getByRole("application").boundingBox();
  const at = (x, y) => page.mouse.click(box.x + x * box.width, box.y + y * box.height);
  const triple = async (term) =>
    (await value(page, "#ruler-figures", term)).match(/−?[\d.]+/g).map(number);
  const check = async () => {
    const [from, to] = [await triple("from"), await triple("to")];
    for (const end of [from, to]) {
      let nearest = Infinity;
      for (let i = 0; i < positions.length; i += 3) {
        const off = Math.hypot(...end.map((x, k) => x - positions[i + k]));
        nearest = Math.min(nearest, off);
      }
      expect(nearest).toBeLessThan(1e-4); // as told in the fourth decimal
    }
    const along = to.map((x, k) => 1000 * (x - from[k]));
    const length = millimeters(await value(page, "#ruler-figures", "distance"));
    expect(Math.abs(length - Math.hypot(...along))).toBeLessThan(0.01 * length + 0.3);
    const each = (await value(page, "#ruler-figures", "dx")).split(", ").map(millimeters);
    each.forEach((step, k) => expect(Math.abs(step - along[k])).toBeLessThan(0.6));
    await expect(page.locator(".mark.ruler")).toHaveText(
      await value(page, "#ruler-figures", "distance"),
    );
    return length;
  };
  await page.keyboard.press("l");
  await at(0.45, 0.5);
  await expect(page.locator("#ruler-figures")).toContainText("to the next place");
  await at(0.6, 0.6);
  const first = await check();
  await expect(page.locator("line.front")).toHaveAttribute("visibility", "visible");

  await page.getByRole("application").focus();
  await page.keyboard.press("Enter");
  for (let k = 0; k < 3; ++k) await page.keyboard.press("Shift+ArrowRight");
  await atRest(page);
  await page.keyboard.press("Enter");
  expect(await check()).not.toBe(first);
  await page.keyboard.press("Escape");
  await expect(page.locator(".mark.ruler")).toBeHidden();
  await expect(page.locator("#ruler")).toHaveAttribute("aria-pressed", "false");
});

test("a section leaves a slab of the scan, which the keys move", async ({ page }) => {
  await openMeasure(page);
  const before = await look(page);
  await page.getByLabel("Across").selectOption("x");
  await expect.poll(() => changed(page, before)).toBeGreaterThan(0.1);
  const thickness = page.getByRole("slider", { name: "Thickness" });
  await thickness.fill("0.2");
  const position = page.getByRole("slider", { name: "Position" });
  await position.focus();
  const start = millimeters(await position.getAttribute("aria-valuetext"));
  for (let k = 0; k < 10; ++k) await page.keyboard.press("ArrowRight");
  const middle = millimeters(await position.getAttribute("aria-valuetext"));
  expect(middle).toBeGreaterThan(start);
  const half = millimeters(await thickness.getAttribute("aria-valuetext")) / 2;
  // What can be picked lies in the slab.
  await page.getByRole("button", { name: "Ruler" }).click();
  const box = await page.getByRole("application").boundingBox();
  const told = page.locator("#ruler-figures");
  const idle = await told.textContent();
  let picked = 0;
  for (let k = 1; k < 16; ++k) {
    await page.mouse.click(box.x + (k / 16) * box.width, box.y + 0.5 * box.height);
    const text = await told.textContent();
    const from = text.match(/[Ff]rom ?(−?[\d.]+)/);
    if (text === idle || !from) continue;
    picked += 1;
    expect(Math.abs(1000 * number(from[1]) - middle)).toBeLessThan(half + 0.1);
  }
  expect(picked).toBeGreaterThan(0);
  await page.keyboard.press("Escape");
  await page.getByLabel("Across").selectOption("view");
  await expect(page.getByRole("button", { name: "Take the view of now" })).toBeVisible();
  await page.getByLabel("Across").selectOption("");
  await page.evaluate(() => document.activeElement.blur());
  await expect.poll(() => changed(page, before)).toBeLessThan(0.001);
});

test("measuring fits on a narrow screen", async ({ page }) => {
  await page.setViewportSize({ width: 390, height: 844 });
  await openMeasure(page);
  await page.getByLabel("Color of the scan").selectOption("distance");
  await page.getByLabel("Across").selectOption("view");
  await foundRows(page).first().click();
  await expect(page.locator(".histogram")).toBeVisible();
  for (const box of ["html", "#panel"]) {
    expect(await page.locator(box).evaluate((element) => element.scrollWidth)).toBe(390);
  }
  const tools = await page.locator("#tools").boundingBox();
  expect(tools.x + tools.width).toBeLessThanOrEqual(390);
});

for (const colorScheme of ["light", "dark"]) {
  test(`every eye tells the colors of deviations apart (${colorScheme})`, async ({ page }) => {
    await page.emulateMedia({ colorScheme });
    await page.goto("/");
    const ground = await page.evaluate(() => {
      const style = getComputedStyle(document.documentElement);
      return style.getPropertyValue("--view").trim();
    });
    const { below, between, above } = kPalettes.deviation;
    const view = [1, 3, 5].map((k) => parseInt(ground.slice(k, k + 2), 16));
    for (const sight of Object.values(kSights)) {
      const looks = [below, ...between, above, view].map((color) => seen(color, sight));
      looks.forEach((one, k) => {
        for (const other of looks.slice(0, k)) {
          expect(Math.hypot(...one.map((x, j) => x - other[j]))).toBeGreaterThan(0.12);
        }
      });
    }
  });
}

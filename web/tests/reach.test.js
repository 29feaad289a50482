/** The page by keyboard, by name, on small screens; and its library. */
import {
  changed,
  expect,
  foundRows,
  look,
  lookedAt,
  openExample,
  openPage,
  pixels,
  test,
} from "./fixtures.js";
import { kSights, seen } from "./sight.js";

/** Press Tab until what has the focus matches. */
async function tabTo(page, selector) {
  for (let presses = 0; presses < 40; ++presses) {
    await page.keyboard.press("Tab");
    if (await page.evaluate((wanted) => document.activeElement.matches(wanted), selector)) return;
  }
  throw new Error(`Tab does not reach ${selector}`);
}

test("keys alone lead from the start to a detection in the view", async ({ page }) => {
  await openPage(page);
  await tabTo(page, "#examples button");
  await page.keyboard.press("Enter");
  await expect(page.locator(".mark.found").first()).toBeVisible();
  const before = await lookedAt(page);
  await tabTo(page, "#found button");
  const outlined = await page.evaluate(() => getComputedStyle(document.activeElement).outlineStyle);
  expect(outlined).not.toBe("none");
  await page.keyboard.press("ArrowDown");
  const second = foundRows(page).nth(1);
  await expect(second).toBeFocused();
  await page.keyboard.press("Enter");
  await expect(second).toHaveAttribute("aria-expanded", "true");
  await expect.poll(() => lookedAt(page)).not.toEqual(before);
});

test("the view turns by arrow keys and fits again", async ({ page }) => {
  await openExample(page);
  const before = await look(page);
  await page.getByRole("application").focus();
  await page.keyboard.press("ArrowLeft");
  await expect.poll(() => changed(page, before)).toBeGreaterThan(0.02);
  await page.keyboard.press("Shift+ArrowUp");
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press("f");
  await expect.poll(() => changed(page, before)).toBeLessThan(0.001);
});

test("the shortcuts are told, and do not act while one types", async ({ page }) => {
  await openExample(page);
  await page.keyboard.press("?");
  const help = page.getByRole("dialog", { name: "Keyboard" });
  await expect(help).toBeVisible();
  await page.keyboard.press("Escape");
  await expect(help).toBeHidden();
  await page.keyboard.press("m");
  await expect(page.getByLabel("Filter")).toBeFocused();
  await page.keyboard.type("m");
  await expect(page.getByRole("tabpanel", { name: "Models" })).toBeVisible();
});

test("all that can be used has a name", async ({ page }) => {
  await openExample(page);
  await page.keyboard.press("r");
  await page.getByText("Settings").click();
  const session = await page.context().newCDPSession(page);
  const usable = [
    "button",
    "link",
    "textbox",
    "searchbox",
    "combobox",
    "spinbutton",
    "tab",
    "tabpanel",
    "dialog",
    "application",
    "toolbar",
    "tablist",
  ];
  for (const panel of ["Result", "Models"]) {
    await page.getByRole("tab", { name: panel }).click();
    const { nodes } = await session.send("Accessibility.getFullAXTree");
    const controls = nodes.filter((node) => !node.ignored && usable.includes(node.role?.value));
    expect(controls.length).toBeGreaterThan(8);
    expect(controls.filter((node) => !node.name?.value)).toEqual([]);
  }
});

for (const colorScheme of ["light", "dark"]) {
  test(`on a narrow screen nothing overflows (${colorScheme})`, async ({ page }) => {
    await page.emulateMedia({ colorScheme });
    await page.setViewportSize({ width: 390, height: 844 });
    const fits = async () =>
      expect(
        await page.evaluate(() => [
          document.documentElement.scrollWidth,
          document.querySelector("#panel").scrollWidth,
        ]),
      ).toEqual([390, 390]);
    await openPage(page);
    await fits();
    await openExample(page);
    await fits();
    await foundRows(page).first().click();
    await page.keyboard.press("r");
    await page.getByText("What do these mean?").click();
    await fits();
    const canvas = await page.getByRole("application").boundingBox();
    const list = await page.locator("#panel").boundingBox();
    expect(canvas.y + canvas.height).toBeLessThanOrEqual(list.y + 1);
    await page.getByText("Settings").click();
    await fits();
    await page.getByText("More options").click();
    await fits();
    await page.getByRole("tab", { name: "Models" }).click();
    await fits();
    for (const near of await page.locator(".near summary").all()) await near.click();
    await fits();
  });
}

test("what nearly looks the same is told turn by turn, with what declares each", async ({ page }) => {
  const turn = (rows, largest, motions = [rows]) => ({
    motions,
    axis: { direction: [0, 0, 1], point: [0.25, 0, 0], turn_deg: motions.length ? 180 : null },
    measured: rows,
    deviation: { median: 0.0001, p90: largest / 2, largest },
    place: [0, 0, 0],
  });
  const about = (x, y) => [[x, 0, 0, 0], [0, y, 0, 0], [0, 0, x * y, 0], [0, 0, 0, 1]]; // prettier-ignore
  const symmetry = { poses: 1, axis: false, axes: [], declared: false };
  symmetry.declaration = { symmetries: [about(1, -1)] };
  await page.route("**/v1/models", async (route) => {
    const response = await route.fetch();
    const library = await response.json();
    for (const model of library.models) {
      model.near_symmetry = { poses: 0, axis: false, axes: [], declaration: null };
    }
    Object.assign(library.models[0], {
      symmetry,
      near_symmetry: { poses: 2, axis: true, axes: [], declaration: { symmetries: [] } },
    });
    library.unit = "m";
    await route.fulfill({ response, json: library });
  });
  await page.route("**/v1/models/*/near-symmetry", (route) =>
    route.fulfill({ json: { turns: [turn(about(-1, -1), 0.0073), turn(about(-1, 1), 0.026, [])] } }),
  );
  await openPage(page);
  await page.keyboard.press("m");
  await expect(page.locator("#model-list .near")).toHaveCount(1);
  await page.getByText("nearly turns freely").click();
  const turns = page.locator("#model-list .near li");
  await expect(turns).toHaveCount(2);
  await expect(turns.first()).toContainText("Turned by 180.0° about 0.00, 0.00, 1.00");
  await expect(turns.first()).toContainText(
    "up to 7.3 mm off itself; a tenth of the surface by more than 3.65 mm, half of it by more than 0.1 mm",
  );
  await expect(turns.last()).toContainText("any angle about 0.00, 0.00, 1.00");
  const copied = await page.evaluate(() => {
    const texts = [];
    Object.defineProperty(navigator, "clipboard", {
      value: { writeText: async (text) => texts.push(text) },
    });
    window.copied = texts;
    return texts;
  });
  expect(copied).toEqual([]);
  for (const one of [turns.first(), turns.last()]) {
    await one.getByRole("button", { name: "Copy declaration" }).click();
  }
  const told = await page.evaluate(() => window.copied.map((text) => JSON.parse(`{${text}}`)));
  expect(told).toEqual([
    { symmetries: [about(1, -1), about(-1, -1)] },
    { symmetries: [about(1, -1)], symmetry_axis: { axis: [0, 0, 1], offset: [0.25, 0, 0] } },
  ]);
  await turns.first().getByRole("button", { name: "Show this turn" }).click();
  await expect(page.locator("#view-title")).toContainText("turned: 7.3 mm off at the ball");
});

test("a bar tells how long things are where the view looks", async ({ page }) => {
  await openExample(page);
  const kTangent = Math.tan((20 * Math.PI) / 180); // of half the field of view
  const meters = (text) => parseFloat(text) * (text.endsWith("mm") ? 0.001 : 1);
  const check = async () => {
    // All of one picture.
    const { length, width, height, look } = await page.evaluate(() => ({
      length: document.querySelector("#scale").textContent,
      width: document.querySelector("#scale .bar").getBoundingClientRect().width,
      height: document.querySelector("#canvas").clientHeight,
      look: document.querySelector("#look").textContent,
    }));
    const pixels = (meters(length) * height) / (2 * kTangent * meters(look.split("from ")[1]));
    expect(Math.abs(width - pixels)).toBeLessThan(0.02 * pixels + 2);
    expect(width).toBeLessThanOrEqual(121);
    return meters(length);
  };
  const before = await check();
  await page.getByRole("application").focus();
  for (let k = 0; k < 8; ++k) await page.keyboard.press("+");
  await expect.poll(check).toBeLessThan(before);
});

test("where the sensor was is shown, unless the view is its own", async ({ page }) => {
  await openExample(page);
  const sensor = page.locator(".mark.sensor");
  await expect(sensor).toBeHidden();
  await page.getByRole("application").focus();
  for (let k = 0; k < 6; ++k) await page.keyboard.press("ArrowLeft");
  await expect(sensor).toHaveText("sensor →");
  const view = await page.getByRole("application").boundingBox();
  const box = await sensor.boundingBox();
  expect(box.x + box.width).toBeLessThanOrEqual(view.x + view.width);
  for (let k = 0; k < 12; ++k) await page.keyboard.press("-");
  await expect(sensor).toHaveText("sensor");
  await page.keyboard.press("f");
});

for (const colorScheme of ["light", "dark"]) {
  test(`every eye tells the colors of the times apart (${colorScheme})`, async ({ page }) => {
    await page.emulateMedia({ colorScheme });
    await openPage(page);
    const colors = await page.evaluate(() =>
      [0, 1, 2, 3, 4, 5].map((k) => {
        const made = document.createElement("span");
        made.className = `tone-${k}`;
        document.body.append(made);
        const color = getComputedStyle(made).backgroundColor.match(/\d+/g).map(Number);
        made.remove();
        return color;
      }),
    );
    for (const sight of Object.values(kSights)) {
      const looks = colors.map((color) => seen(color, sight));
      looks.forEach((look, k) => {
        for (const other of looks.slice(0, k)) {
          const difference = Math.hypot(...look.map((value, j) => value - other[j]));
          expect(difference).toBeGreaterThan(0.15);
        }
      });
    }
  });
}

test("the library shows its models, in thumbnails and in the view", async ({ page, request }) => {
  const { models } = await (await request.get("/v1/models")).json();
  await openPage(page);
  await page.keyboard.press("m");
  const entries = page.getByRole("tabpanel", { name: "Models" }).getByRole("listitem");
  await expect(entries).toHaveCount(models.length);
  for (const [k, model] of models.entries()) {
    await expect(entries.nth(k)).toContainText(model.name);
    await entries.nth(k).scrollIntoViewIfNeeded();
    await expect
      .poll(() =>
        entries
          .nth(k)
          .locator("img")
          .evaluate((image) => image.naturalWidth),
      )
      .toBeGreaterThan(0);
  }
  await page.getByLabel("Filter").fill(models[0].name);
  await expect(entries.filter({ visible: true })).toHaveCount(
    models.filter((model) => model.name.includes(models[0].name)).length,
  );
  const box = await page.getByRole("application").boundingBox();
  const middle = {
    x: box.x + box.width / 2 - 60,
    y: box.y + box.height / 2 - 60,
    width: 120,
    height: 120,
  };
  const shades = async () => new Set(await pixels(page, middle)).size;
  await page.locator("#welcome").evaluate((welcome) => (welcome.hidden = true));
  expect(await shades()).toBeLessThan(8);
  await entries.first().getByRole("button").click();
  await expect.poll(shades).toBeGreaterThan(8);
  await expect(entries.first().getByRole("button")).toHaveAttribute("aria-current", "true");
});

test("a model by itself gives way to the scan again", async ({ page }) => {
  await openExample(page);
  const before = await look(page);
  await page.getByRole("tab", { name: "Models" }).click();
  await page.locator("#model-list button").first().click();
  await expect.poll(() => changed(page, before)).toBeGreaterThan(0.02);
  await page.getByRole("tab", { name: "Result" }).click();
  await expect.poll(() => changed(page, before)).toBeLessThan(0.001);
});

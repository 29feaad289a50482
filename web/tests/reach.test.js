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
    await page.getByRole("tab", { name: "Models" }).click();
    await fits();
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

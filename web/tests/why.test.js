/** Asking why a model is found at a place of the scan, or is not. */
import { expect, foundRows, openExample, test } from "./fixtures.js";

const whyRows = (page) => page.locator("#why .pose");

/** Ask about the place behind the mark of the first detection. */
async function askAtFirst(page) {
  await page.keyboard.press("w");
  await expect(page.getByRole("button", { name: "Why?" })).toHaveAttribute("aria-pressed", "true");
  const box = await page.locator(".mark.found").first().boundingBox();
  const asked = page.waitForResponse((response) => response.url().includes("explain="));
  await page.locator("#canvas").click({
    position: await page.locator("#canvas").evaluate(
      (canvas, { x, y }) => {
        const { left, top } = canvas.getBoundingClientRect();
        return { x: x - left, y: y - top };
      },
      { x: box.x + box.width / 2, y: box.y + box.height / 2 },
    ),
    force: true,
  });
  return (await asked).json();
}

test("a place of the scan is asked about, and every model answers", async ({ page }) => {
  const { detections } = await openExample(page);
  const answer = await askAtFirst(page);
  const { models } = answer.scenes[0].explanation;
  expect(models.length).toBeGreaterThan(0);
  await expect(whyRows(page)).toHaveCount(models.length);
  for (const [k, explained] of models.entries()) {
    await expect(whyRows(page).nth(k).locator(".name")).toHaveText(explained.model);
    await expect(whyRows(page).nth(k)).toContainText(explained.words);
  }
  expect(models[0].detection).not.toBeNull();
  await expect(whyRows(page).first()).toContainText("is found here with a score of");
  await expect(whyRows(page).first()).toHaveAttribute("aria-pressed", "true");
  // What its rays say, by the counts that stand beside their colors.
  const legend = whyRows(page).first().locator(".rays");
  const told = Object.entries(models[0].rays).filter(([, places]) => places.length);
  await expect(legend.locator("> span")).toHaveCount(told.length);
  await expect(legend).toContainText(`agrees ${models[0].rays.agrees.length / 3}`);
  // What was found stays as it was, below the answer; the view looks at the model that lies there.
  await expect(foundRows(page)).toHaveCount(detections.length);
  await expect(page.locator("#found [aria-expanded=true]")).toHaveCount(0);
  await expect(page.locator("#why-title")).toBeInViewport();
  await expect(page.locator("#why-note")).toContainText(", was found here.");
  await expect(page.locator(".mark.found.selected")).toHaveCount(1);
});

test("a pose that was not reported is drawn where it was tested", async ({ page }) => {
  await openExample(page);
  const { models } = (await askAtFirst(page)).scenes[0].explanation;
  const k = models.findIndex(({ detection, pose }) => detection === null && pose);
  test.skip(k < 0, "every model that comes near is found");
  await whyRows(page).nth(k).click();
  await expect(page.locator(".mark.why").filter({ visible: true })).toHaveCount(1);
});

test("the middle of the view is asked about by the keyboard", async ({ page }) => {
  await openExample(page);
  await page.keyboard.press("w");
  await expect(page.locator("#tool-hint")).toContainText("Click a place");
  await expect(page.locator("#canvas")).toBeFocused();
  const asked = page.waitForResponse((response) => response.url().includes("explain="));
  await page.keyboard.press("Enter");
  await asked;
  await expect(page.locator("#why-note")).toContainText("At ");
  await page.keyboard.press("Escape");
  await expect(page.locator("#tool-hint")).toBeEmpty();
  await expect(page.locator("#ask")).toHaveAttribute("aria-pressed", "false");
});

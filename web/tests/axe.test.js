/** What axe-core finds at fault in the page, in each of its states. */
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

import { expect, openExample, openPage, test } from "./fixtures.js";

const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

/** Each finding as "rule: what it is about". */
async function faults(page) {
  await page.evaluate(axe);
  return page.evaluate(async () => {
    const { violations } = await globalThis.axe.run(document);
    return violations.flatMap(({ id, nodes }) =>
      nodes.map(({ target, failureSummary }) => `${id}: ${target} ${failureSummary}`),
    );
  });
}

const openAll = (page) =>
  page.evaluate(() => document.querySelectorAll("details").forEach((box) => (box.open = true)));

for (const colorScheme of ["light", "dark"]) {
  test.describe(colorScheme, () => {
    test.use({ colorScheme });

    test(`nothing is at fault before and after a scan, in ${colorScheme} colors`, async ({ page }) => {
      await openPage(page);
      expect(await faults(page)).toEqual([]);
      await openExample(page);
      await page.locator("#found .pose").first().click();
      await openAll(page);
      expect(await faults(page)).toEqual([]);
      for (const tab of ["Models", "Session"]) {
        await page.getByRole("tab", { name: tab }).click();
        await openAll(page);
        expect(await faults(page)).toEqual([]);
      }
      await page.keyboard.press("?");
      expect(await faults(page)).toEqual([]);
    });
  });
}

/** A part's way from a file to the library, and models renamed and removed. */
import { expect, openPage, test } from "./fixtures.js";

/** An ASCII STL of a box with these sides. */
function boxFile(name, ...sides) {
  const corner = (k) => [0, 1, 2].map((axis) => (((k >> axis) & 1) - 0.5) * sides[axis]).join(" ");
  const quads = ["0264", "1573", "0451", "2376", "0132", "4675"]; // outward by the right hand
  const facets = quads.flatMap(([a, b, c, d]) =>
    [[a, b, c], [a, c, d]].map(
      (face) =>
        "facet normal 0 0 0\nouter loop\n" +
        face.map((k) => `vertex ${corner(Number(k))}\n`).join("") +
        "endloop\nendfacet\n",
    ),
  );
  const text = `solid box\n${facets.join("")}endsolid box\n`;
  return { name, mimeType: "model/stl", buffer: Buffer.from(text) };
}

const part = (page, name) => page.locator(".part").filter({ has: page.getByText(name, { exact: true }) });

async function bring(page, ...files) {
  await page.keyboard.press("m");
  await page.getByLabel("Unit of the files").selectOption("mm");
  await page.locator("#part-files").setInputFiles(files);
}

test("a part is trained, looked at, published, renamed and removed", async ({ page }) => {
  await openPage(page);
  await bring(page, boxFile("my box.stl", 60, 40, 20));
  const box = part(page, "my_box");
  // The diagonal; half turns about three axes and none.
  await expect(box).toContainText("74.8 mm across, 12 triangles, looks the same in 4 poses");
  await expect(page.locator("#library-facts")).toContainText("2 models");
  await box.getByRole("button", { name: "Show" }).click();
  await expect(page.locator("#view-title")).toHaveText("my_box");
  await box.getByRole("button", { name: "Publish" }).click();
  await expect(page.locator("#library-facts")).toContainText("3 models");
  await expect(box).toHaveCount(0);
  await page.getByLabel("Rename or remove my_box").click();
  await page.getByLabel("New name of my_box").fill("crate");
  await page.getByRole("button", { name: "Rename my_box" }).click();
  await expect(page.locator("#model-list")).toContainText("crate");
  await page.getByLabel("Rename or remove crate").click();
  await page.getByRole("button", { name: "Remove crate" }).click();
  await expect(page.locator("#library-facts")).toContainText("2 models");
});

test("a part of a name that the library has is published as its replacement", async ({ page }) => {
  await openPage(page);
  const box = part(page, "twice");
  await bring(page, boxFile("twice.stl", 60, 40, 20));
  for (const button of ["Publish", "Replace"]) {
    if (button === "Replace") {
      await page.locator("#part-files").setInputFiles(boxFile("twice.stl", 60, 40, 30));
    }
    await box.getByRole("button", { name: button }).click();
    await expect(page.locator("#parts-note")).toHaveText(
      "twice is in the library, and looked for from now on.",
    );
    await expect(page.locator("#library-facts")).toContainText("3 models");
  }
  await page.getByLabel("Rename or remove twice").click();
  await page.getByRole("button", { name: "Remove twice" }).click();
  await expect(page.locator("#library-facts")).toContainText("2 models");
});

test("near symmetries are declared turn by turn, by how far off each is, and undone", async ({
  page,
}) => {
  await openPage(page);
  // Nearly square: a quarter turn lays sides of 30 mm where those of 29 mm are.
  await bring(page, boxFile("block.stl", 60, 58, 20));
  const block = part(page, "block");
  await expect(block).toContainText("looks the same in 4 poses");
  await block.getByText("looks nearly the same in").click();
  const turns = block.locator(".near li");
  await expect(turns.first()).toBeVisible();
  const quarter = turns.filter({ hasText: /(89|90)\.\d° about 0.00, 0.00, −?1.00/ }).first();
  await expect(quarter).toContainText(/up to (0\.9\d|1(\.\d+)?) mm off itself/);
  await quarter.getByRole("button", { name: "Show this turn" }).click();
  await expect(page.locator("#view-title")).toContainText(/block, turned: [01.]+\d* mm off at the ball/);

  const words = [];
  page.on("dialog", (dialog) => words.push(dialog.message()));
  await quarter.getByRole("button", { name: "Declare this turn" }).click();
  // With the quarter turns, the half turns between them.
  await expect(block).toContainText("looks the same in 8 poses, as declared");
  await expect(block.locator(".near")).toHaveCount(0);
  expect(words).toHaveLength(1);
  expect(words[0]).toMatch(/Declare that block looks the same turned by .*up to .* mm off itself/s);
  await block.getByRole("button", { name: "Undo declaration" }).click();
  await expect(block).toContainText("looks the same in 4 poses");
  await expect(block).not.toContainText("as declared");
  await block.getByText("looks nearly the same in").click();
  await expect(quarter).toBeVisible();
  await block.getByRole("button", { name: "Discard" }).click();
  await expect(block).toHaveCount(0);
});

test("a damaged file is refused with its reason, and another one trained", async ({ page }) => {
  await openPage(page);
  const whole = boxFile("cut.stl", 60, 40, 20);
  await bring(
    page,
    { ...whole, buffer: whole.buffer.subarray(0, 700) },
    boxFile("cube.stl", 30, 30, 30),
  );
  await expect(part(page, "cube")).toContainText("looks the same in 24 poses");
  await expect(part(page, "cut")).toContainText("cut.stl, line");
  await expect(part(page, "cut").getByRole("button", { name: "Publish" })).toHaveCount(0);
  for (const name of ["cut", "cube"]) {
    await part(page, name).getByRole("button", { name: "Discard" }).click();
    await expect(part(page, name)).toHaveCount(0);
  }
});

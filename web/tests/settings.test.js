/** Every option, the limits in the view, and the same request elsewhere. */
import { execFileSync } from "node:child_process";
import { copyFileSync, mkdirSync, mkdtempSync, rmSync, symlinkSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, dirname, join } from "node:path";

import {
  atRest,
  chooseFiles,
  exampleFiles,
  expect,
  foundRows,
  openExample,
  openPage,
  recognized,
  test,
} from "./fixtures.js";

const kElsewhere = [
  "format",
  "camera",
  "depth",
  "distortion",
  "image-size",
  "viewpoint",
  "unit",
  "rejected",
];

/** The parameters that the form is for, as the service describes them. */
async function describedOptions(request) {
  const { paths, components } = await (await request.get("/v1/openapi.json")).json();
  return paths["/v1/recognize"].post.parameters
    .map(({ $ref }) => components.parameters[$ref.split("/").pop()])
    .filter((parameter) => parameter.in === "query" && !kElsewhere.includes(parameter.name));
}

async function openOptions(page) {
  await page.getByText("Settings").click();
  await page.getByText("More options").click();
  const closed = page.locator("#options > details:not([open]) > summary");
  while (await closed.count()) await closed.first().click();
}

/** Recognize again; returns the parameters that were sent, and the scene of the answer. */
async function askAgain(page) {
  const sent = page.waitForRequest(/v1\/recognize/);
  const scene = await recognized(page, () =>
    page.getByRole("button", { name: "Recognize" }).click(),
  );
  return { sent: new URL((await sent).url()).searchParams, scene };
}

const optionOf = (page, name) => page.locator(".option", { has: page.locator(`[name="${name}"]`) });

test("every option stands below its heading, and what a preset makes of it is shown", async ({
  page,
  request,
}) => {
  const described = await describedOptions(request);
  await openExample(page);
  await openOptions(page);
  for (const { name, "x-group": group } of described) {
    await expect(page.locator(`[name="${name}"]`)).toBeVisible();
    if (["method", "min-score"].includes(name)) continue;
    const box = page.locator("#options > details", { has: page.locator(`[name="${name}"]`) });
    await expect(box.locator("summary")).toContainText(group);
  }
  const numbers = described.filter(
    ({ name, schema }) => schema.default && /integer|number/.test(schema.type) && name !== "min-score",
  );
  const presets = described.find(({ name }) => name === "preset")["x-presets"];
  await page.locator('[name="max-refined"]').fill("33");
  for (const [preset, values] of Object.entries(presets)) {
    await page.locator('[name="preset"]').selectOption(preset);
    const shown = await page
      .locator('#options input[type="number"][name]')
      .evaluateAll((inputs) => inputs.map(({ name, placeholder }) => [name, placeholder]));
    const told = Object.fromEntries(shown);
    for (const { name, schema } of numbers) {
      expect([name, Number(told[name])]).toEqual([name, values[name] ?? schema.default]);
    }
    await expect(page.locator('[name="max-refined"]')).toHaveValue("33");
  }
});

test("what is set is sent, marked, counted, and taken back", async ({ page }) => {
  await openExample(page);
  await openOptions(page);
  await page.locator('[name="max-instances"]').fill("1");
  await page.locator('[name="require-pose"]').check();
  await page.locator('[name="preset"]').selectOption("fast");
  await page.locator('[name="max-refined"]').fill("20"); // as the preset has it, but meant
  await page.locator('[name="max-refined"]').press("Tab");
  await expect(page.locator("#options-count")).toHaveText("4 changed");
  await expect(page.locator("#options > details", { hasText: "Answers" }).first()).toContainText(
    "2 changed",
  );
  const { sent } = await askAgain(page);
  expect(sent.get("max-instances")).toBe("1");
  expect(sent.get("require-pose")).toBe("true");
  expect(sent.get("preset")).toBe("fast");
  expect(sent.get("max-refined")).toBe("20");
  expect(sent.has("max-votes")).toBe(false);

  await optionOf(page, "max-instances").getByRole("button", { name: /to 100$/ }).click();
  await expect(page.locator('[name="max-instances"]')).toBeFocused();
  await expect(page.locator(".option.set")).toHaveCount(3);
  await page.getByRole("button", { name: "Reset all" }).click();
  await expect(page.locator(".option.set")).toHaveCount(0);
  await expect(page.locator('[name="preset"]')).toHaveValue("balanced");
});

test("options are found by words, and explained to eyes and ears", async ({ page, request }) => {
  const described = await describedOptions(request);
  const { description } = described.find(({ name }) => name === "max-peaks");
  await openPage(page);
  await openOptions(page);
  await page.getByLabel("Find an option").fill("poses reference");
  const expected = described
    .filter(({ name, description: text, "x-label": label }) =>
      ["poses", "reference"].every((word) => `${name} ${label} ${text}`.toLowerCase().includes(word)),
    )
    .map(({ name }) => name);
  const shown = page.locator("#options [name]:visible");
  await expect(shown).toHaveCount(expected.length);
  await expect(page.locator("#options-found")).toHaveText(`${expected.length} options`);
  const peaks = page.locator('[name="max-peaks"]');
  await expect(peaks).toHaveAccessibleDescription(new RegExp(description.slice(0, 30)));
  const help = optionOf(page, "max-peaks").locator(".help");
  await expect(help).toBeHidden();
  await page.getByRole("button", { name: "Explain each" }).click();
  await expect(help).toHaveText(`${description} 1 to 8.`);
});

test("a number that cannot be is told before it is sent", async ({ page }) => {
  await openExample(page);
  await openOptions(page);
  await page.locator('[name="max-overlap"]').fill("1.5");
  await page.getByRole("button", { name: "Recognize" }).click();
  await expect(page.getByRole("alert")).toContainText("expected a number 0 to 1, found “1.5”");
  await expect(page.locator('[name="max-overlap"]')).toBeFocused();
  await page.locator('[name="max-overlap"]').fill("");
  await page.getByLabel("Region from x").fill("1");
  await page.getByRole("button", { name: "Recognize" }).click();
  await expect(page.getByRole("alert")).toContainText("Region: expected 6 numbers");
});

test("models are ticked instead of typed", async ({ page }) => {
  const { detections } = await openExample(page);
  const wanted = detections[0].model;
  await openOptions(page);
  const models = page.getByRole("group", { name: "Models searched" });
  await expect(models.getByRole("status")).toHaveText("all");
  await models.getByLabel(wanted).check();
  await expect(models.getByRole("status")).toHaveText(/^1 of \d+$/);
  const { sent, scene } = await askAgain(page);
  expect(sent.get("models")).toBe(wanted);
  expect(new Set(scene.detections.map(({ model }) => model))).toEqual(new Set([wanted]));
});

// Limits.

const kRegion = ["from x", "from y", "from z", "to x", "to y", "to z"].map((words) => `Region ${words}`);

const numbersOf = (page, name) =>
  page
    .locator(`[name="${name}"] input`)
    .evaluateAll((inputs) => inputs.map(({ value }) => Number(value)));

/** The middle of a handle [pixel of the page]. */
async function middleOf(page, title) {
  const handle = page.locator("#guides .handle", { has: page.locator("title", { hasText: title }) });
  const { x, y, width, height } = await handle.locator("circle").first().boundingBox();
  return [x + width / 2, y + height / 2];
}

async function drag(page, title, [across, down]) {
  const [x, y] = await middleOf(page, title);
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + across, y + down, { steps: 4 });
  await page.mouse.up();
  return [x + across, y + down];
}

const off = ([x, y], [otherX, otherY]) => Math.hypot(x - otherX, y - otherY);

/** An example with all of it in view, from the side. */
async function openAside(page) {
  const scene = await openExample(page);
  await page.getByRole("application").focus();
  for (const key of ["ArrowLeft", "ArrowLeft", "ArrowLeft", "ArrowUp", "ArrowUp", "-", "-", "-", "-"]) {
    await page.keyboard.press(key);
  }
  await atRest(page);
  return scene;
}

/** Corners of the box around an example's points, by the service's own account of them. */
async function boundsOf(request) {
  const { examples } = await (await request.get("/v1/examples")).json();
  const body = await (await request.get(examples[0].url)).body();
  const answer = await request.post(`/v1/points?${examples[0].query}`, { data: body });
  const bytes = await answer.body();
  const offset = (answer.headers()["x-offset"] ?? "0,0,0").split(",").map(Number);
  const [low, high] = [offset.map(() => Infinity), offset.map(() => -Infinity)];
  for (let i = 0; i < bytes.length / 4; ++i) {
    const value = bytes.readFloatLE(4 * i) + offset[i % 3];
    low[i % 3] = Math.min(low[i % 3], value);
    high[i % 3] = Math.max(high[i % 3], value);
  }
  return [...low, ...high];
}

test("a box is drawn around what is seen, dragged, typed, and heeded", async ({ page, request }) => {
  const { detections } = await openAside(page);
  await openOptions(page);
  await page.getByRole("button", { name: "Box" }).click();
  const bounds = await boundsOf(request);
  const made = await numbersOf(page, "region");
  made.forEach((value, k) => expect(Math.abs(value - bounds[k])).toBeLessThan(1e-4));
  const all = await askAgain(page);
  expect(all.sent.get("region").split(",").map(Number)).toEqual(made);
  expect(all.scene.detections.length).toBe(detections.length);

  const to = await drag(page, "to x", [-30, 0]);
  const dragged = await numbersOf(page, "region");
  expect(dragged[3]).not.toBe(made[3]);
  expect(dragged.filter((value, k) => value !== made[k])).toEqual([dragged[3]]);
  expect(Math.abs((await middleOf(page, "to x"))[0] - to[0])).toBeLessThan(12); // along its axis

  const before = await middleOf(page, "to x");
  await page.getByLabel(kRegion[3]).fill(String(made[3]));
  await page.getByLabel(kRegion[3]).press("Tab");
  await expect.poll(async () => off(await middleOf(page, "to x"), before)).toBeGreaterThan(10);

  // Away from every model.
  for (const [k, words] of kRegion.entries()) {
    await page.getByLabel(words).fill(String(bounds[5] + (k < 3 ? 10 : 11)));
  }
  const away = await askAgain(page);
  expect(away.scene.detections).toEqual([]);
  await page.getByRole("application").focus();
  await page.keyboard.press("b");
  await expect(page.getByLabel(kRegion[0])).toHaveValue("");
  await expect(page.locator("#guides .handle:not(.gone)")).toHaveCount(0);
});

test("a tilt is an arrow and a cone to drag", async ({ page }) => {
  await openAside(page);
  await openOptions(page);
  await page.getByRole("application").focus();
  await page.keyboard.press("t");
  expect(await numbersOf(page, "tilt")).toEqual([0, 0, 1, 0, -1, 0, 30]); // a camera's y is down
  const rim = await drag(page, "angle of the limit", [10, 6]);
  const wider = await numbersOf(page, "tilt");
  expect(wider[6]).toBeGreaterThan(30);
  expect(wider.slice(0, 6)).toEqual([0, 0, 1, 0, -1, 0]);
  expect(off(await middleOf(page, "angle of the limit"), rim)).toBeLessThan(4);
  const tip = await drag(page, "direction of the limit", [-12, 9]);
  const turned = await numbersOf(page, "tilt");
  expect(Math.hypot(...turned.slice(3, 6))).toBeCloseTo(1, 2);
  expect(turned[6]).toBe(wider[6]);
  expect(off(await middleOf(page, "direction of the limit"), tip)).toBeLessThan(4);
  const { sent, scene } = await askAgain(page);
  expect(sent.get("tilt").split(",").map(Number)).toEqual(turned);
  for (const { T_scene_model: rows } of scene.detections) {
    const cosine = [0, 1, 2].reduce((sum, row) => sum + rows[row][2] * turned[3 + row], 0);
    expect((180 / Math.PI) * Math.acos(cosine)).toBeLessThan(turned[6] + 0.5);
  }
});

// Elsewhere.

/** The same request as another program is to write it. */
async function commandOf(page, kind) {
  await page.locator("#command-kind").selectOption(kind);
  return page.locator("#command").textContent();
}

/** What a shell gives to a program in some lines that call it. */
function wordsOf(program, lines, cwd) {
  const script = `${program}() { printf '%s\\0' "$@"; }\n${lines}`;
  return execFileSync("sh", ["-c", script], { cwd }).toString().split("\0").slice(0, -1);
}

async function withFolder(act) {
  const folder = mkdtempSync(join(tmpdir(), "trivet-command-"));
  try {
    return await act(folder);
  } finally {
    rmSync(folder, { recursive: true });
  }
}

test("the request is told for a shell, for curl and for Python", async ({ page, request }) => {
  const [scan, camera] = await exampleFiles(request);
  const name = `it's $HOME "here" ${scan.name}`;
  await openPage(page);
  await recognized(page, () => chooseFiles(page, [{ ...scan, name }, ...(camera ? [camera] : [])]));
  await openOptions(page);
  await page.locator('[name="max-instances"]').fill("2");
  await page.locator('[name="require-pose"]').check();
  await page.getByRole("group", { name: "Left out" }).getByLabel("background").check();
  for (const [k, words] of kRegion.entries()) await page.getByLabel(words).fill(k < 3 ? "-9" : "9");
  const { sent } = await askAgain(page);
  await page.getByText("From a shell or a program").click();

  const curl = wordsOf("curl", await commandOf(page, "curl"), ".");
  const url = new URL(curl[0]);
  expect(url.origin + url.pathname).toBe(`${new URL(page.url()).origin}/v1/recognize`);
  expect([...url.searchParams]).toEqual([...sent]);
  const answer = await request.post(url.href, {
    headers: { "Content-Type": curl[curl.indexOf("-H") + 1].split(": ")[1] },
    data: scan.buffer,
  });
  expect(answer.ok()).toBe(true);
  expect(curl[curl.indexOf("--data-binary") + 1]).toBe(`@${name}`);

  await withFolder(async (folder) => {
    const words = wordsOf("trivet", await commandOf(page, "trivet"), folder);
    expect(words.slice(0, 3)).toEqual(["recognize", "l.h5", name]);
    const rest = words.slice(3).join(" ");
    expect(rest).toContain("--max-instances 2");
    expect(rest).toContain("--require-pose");
    expect(rest).toContain("--ablate background");
    expect(rest).toContain("--region=-9,-9,-9,9,9,9");
    const python = await commandOf(page, "python");
    const call = execFileSync("python3", ["-"], {
      input: `import ast, json
call = ast.parse(${JSON.stringify(python)}).body[-1].value
print(json.dumps([ast.literal_eval(call.args[0]), {k.arg: ast.literal_eval(k.value) for k in call.keywords}]))`,
    });
    const [file, options] = JSON.parse(call);
    expect(file).toBe(name);
    expect(options).toMatchObject({
      max_instances: 2,
      require_pose: true,
      ablate: ["background"],
      region: [-9, -9, -9, 9, 9, 9],
      unit: sent.get("unit"),
      min_score: Number(sent.get("min-score")),
    });
  });
});

test("the command finds what the page found", async ({ page, request }) => {
  const { TRIVET_PROGRAM: program, TRIVET_LIBRARY: library } = process.env;
  test.skip(!program || !library, "there is no program beside the service");
  await openExample(page);
  await openOptions(page);
  await page.locator('[name="preset"]').selectOption("fast");
  await page.getByRole("group", { name: "Left out" }).getByLabel("contour").check();
  const { scene } = await askAgain(page);
  await page.getByText("From a shell or a program").click();
  const command = await commandOf(page, "trivet");
  const { examples } = await (await request.get("/v1/examples")).json();
  await withFolder(async (folder) => {
    copyFileSync(library, join(folder, basename(library)));
    mkdirSync(join(folder, dirname(examples[0].name)), { recursive: true });
    writeFileSync(join(folder, examples[0].name), await (await request.get(examples[0].url)).body());
    symlinkSync(program, join(folder, "trivet"));
    const answer = execFileSync("sh", ["-c", command], {
      cwd: folder,
      env: { ...process.env, PATH: `${folder}:${process.env.PATH}` },
      stdio: ["ignore", "pipe", "ignore"],
    });
    const poses = ({ detections }) =>
      detections.map(({ model, score, T_scene_model }) => ({ model, score, T_scene_model }));
    expect(scene.detections.length).toBeGreaterThan(0);
    expect(poses(JSON.parse(answer).scenes[0])).toEqual(poses(scene));
  });
});

test("a link brings back the scan and all that is set", async ({ page }) => {
  await openExample(page, 1);
  await openOptions(page);
  await page.locator('[name="preset"]').selectOption("accurate");
  await page.locator('[name="max-peaks"]').fill("3");
  await page.getByLabel("Lowest score").fill("0.5");
  for (const [k, words] of kRegion.entries()) await page.getByLabel(words).fill(k < 3 ? "-9" : "9");
  const { sent } = await askAgain(page);
  await expect.poll(() => new URL(page.url()).hash).toContain("region=-9,-9,-9,9,9,9");

  const asked = page.waitForRequest(/v1\/recognize/);
  await page.reload();
  expect([...new URL((await asked).url()).searchParams].sort()).toEqual([...sent].sort());
  await expect(foundRows(page).first()).toBeVisible();
  await expect(page.locator("#link-ignored")).toBeHidden();

  // Another one in the same page.
  const again = page.waitForRequest(/v1\/recognize/);
  await page.evaluate(() => (location.hash = location.hash.replace("max-peaks=3", "max-peaks=4")));
  expect(new URL((await again).url()).searchParams.get("max-peaks")).toBe("4");
});

test("of a link, what cannot be is told and ignored", async ({ page, request }) => {
  const { examples } = await (await request.get("/v1/examples")).json();
  const asked = page.waitForRequest(/v1\/recognize/);
  const hostile = "models=%3Cimg src=x onerror=alert(1)%3E&max-peaks=99&__proto__=1&rejected=5&rounds=1";
  await page.goto(`/#example=${encodeURIComponent(examples[0].name)}&${hostile}`);
  const sent = new URL((await asked).url()).searchParams;
  expect(sent.has("models")).toBe(false);
  expect(sent.has("max-peaks")).toBe(false);
  expect(sent.has("__proto__")).toBe(false);
  expect(sent.get("rejected")).toBe("3");
  expect(sent.get("rounds")).toBe("1");
  const note = page.locator("#link-ignored");
  await expect(note).toContainText("found “99”");
  await expect(note).toContainText("__proto__: nothing of this name can be set.");
  await expect(note).toContainText("rejected: nothing of this name can be set.");
  await expect(page.locator("#link-ignored img")).toHaveCount(0);
  await page.evaluate(() => (location.hash = "example=none"));
  await expect(note).toContainText("the service offers no “none”");
});

test("a file of one's own is not in the link, and that is said", async ({ page, request }) => {
  await openPage(page);
  await recognized(page, async () => chooseFiles(page, await exampleFiles(request)));
  await page.getByText("Settings").click();
  await expect(page.locator("#link-note")).toContainText(/scan\.\w+ is not in it/);
  await expect.poll(() => new URL(page.url()).hash).not.toContain("example=");
});

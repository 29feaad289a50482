import { defineConfig } from "@playwright/test";

const kTestSeconds = 120; // pictures are drawn without a GPU, maybe beside other tests

export default defineConfig({
  testDir: ".",
  testMatch: "*.test.js",
  outputDir: "../node_modules/.test-results",
  globalSetup: "./service.js",
  workers: 1,
  forbidOnly: true,
  timeout: 1000 * kTestSeconds,
  expect: { timeout: (1000 * kTestSeconds) / 2 },
  reporter: [["list"]],
  use: {
    viewport: { width: 1100, height: 720 },
    deviceScaleFactor: 0.5, // a quarter of the pixels, which are drawn without a GPU
    contextOptions: { reducedMotion: "reduce" }, // flights of the camera are jumps
    launchOptions: {
      executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
      args: [
        "--no-sandbox",
        "--use-gl=angle",
        "--use-angle=swiftshader",
        "--enable-unsafe-swiftshader",
        "--disable-background-networking",
        "--disable-component-update",
        "--disable-sync",
        "--no-first-run",
      ],
    },
  },
});

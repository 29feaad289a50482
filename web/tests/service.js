import { execFileSync, spawn } from "node:child_process";
import { once } from "node:events";
import { mkdirSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";

export async function addressOf(service) {
  const told = [];
  for await (const line of createInterface({ input: service.stderr })) {
    told.push(line);
    const found = line.match(/http:\/\/[0-9.]+:[0-9]+/);
    if (found) return found[0];
  }
  throw new Error(`the service ended without an address:\n${told.join("\n")}`);
}

/**
 * Start a service with two parts and two scans of them for all tests, and end it after them.
 *
 * TRIVET_PROGRAM names the program. TRIVET_URL is where the service is; if it is set, a service with
 * examples and a session runs there already. TRIVET_LIBRARY is the file that it serves, TRIVET_FOLDER
 * where all of it lies.
 */
export default async function startService() {
  if (process.env.TRIVET_URL) return undefined;
  const program = process.env.TRIVET_PROGRAM;
  if (!program) throw new Error("expected TRIVET_PROGRAM, the path of trivet");
  const folder = mkdtempSync(join(tmpdir(), "trivet-page-"));
  const run = (...words) => execFileSync(program, words, { cwd: folder, stdio: "pipe" });
  run(
    "scan",
    "--parts",
    "2",
    "-o",
    "scans",
    "--scenes",
    "2",
    "--instances",
    "3",
    "--sensor",
    "laser",
    "--resolution",
    "0.5",
  );
  run("train", "scans/manifest.json", "--methods", "ppf", "-o", "l.h5");
  mkdirSync(join(folder, "live"));
  const { unit, scenes } = JSON.parse(readFileSync(join(folder, "scans/manifest.json")));
  const { camera } = scenes[0];
  const service = spawn(
    program,
    [
      "serve",
      "l.h5",
      "--port",
      "0",
      "--examples",
      "scans/manifest.json",
      "--allow-training",
      "drafts",
      "--watch",
      "live",
      "--watch-query",
      `unit=${unit}&camera=${["fx", "fy", "cx", "cy", "depth_scale"].map((key) => camera[key])}`,
      "--session",
      "session",
      "--drain-grace-ms",
      "0",
    ],
    { cwd: folder, stdio: ["ignore", "ignore", "pipe"] },
  );
  const ended = once(service, "exit");
  process.env.TRIVET_FOLDER = folder;
  process.env.TRIVET_URL = await addressOf(service);
  process.env.TRIVET_LIBRARY = join(folder, "l.h5");
  service.stderr.resume();
  return async () => {
    service.kill("SIGTERM");
    await ended;
    rmSync(folder, { recursive: true });
  };
}

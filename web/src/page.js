import { Matrix4, Vector3 } from "three";

import { adviceView } from "./advice_view.js";
import { showAnswer } from "./answer.js";
import { detectionColors } from "./colors.js";
import { showCommands } from "./command_panel.js";
import { byId, element, moveByArrows } from "./dom.js";
import { showExamples } from "./examples.js";
import { LibraryPanel } from "./library_panel.js";
import { LiveStrip } from "./live_strip.js";
import { unitThatFits } from "./extents.js";
import { Limits } from "./limits.js";
import { readLink, tellIgnored, writeLink } from "./link.js";
import { Measure } from "./measure/measure.js";
import { listenForFiles } from "./open_files.js";
import { PartsPanel } from "./parts_panel.js";
import { PoseList } from "./pose_list.js";
import { Pulse } from "./pulse.js";
import { worthTelling } from "./rejected.js";
import { robotPoseView } from "./robot/pose_view.js";
import { Robot } from "./robot/robot.js";
import { RobotPanel } from "./robot/robot_panel.js";
import { showScale } from "./scale_bar.js";
import { mayBeDepthImage, readFiles, scanOfExample } from "./scan.js";
import * as service from "./service.js";
import { SessionTab } from "./session/session_tab.js";
import { Settings } from "./settings.js";
import { timesView } from "./times.js";
import { unitScale } from "./units.js";
import { fetchWords } from "./vocabulary.js";
import { Meshes } from "./view/meshes.js";
import { SceneView } from "./view/scene_view.js";
import { verdictWords, WhyList } from "./why_list.js";
import {
  countWords,
  lengthWords,
  numbered,
  placeWords,
  pointWords,
  rejectionWords,
  secondsWords,
} from "./words.js";

const kToolHints = {
  ask: "Click a place to learn why a part is found there, or none; Enter: the middle. Esc ends.",
  ruler: "Click two points; Enter: the middle of the view. Esc ends.",
};
const kAloneColor = "#8fa3b8"; // of a model shown by itself

const meshes = new Meshes();
const view = makeView();
const lists = {
  found: new PoseList(
    byId("found"),
    (id) => select(id),
    (id) => session.buttonsFor(id),
  ),
  rejected: new PoseList(byId("rejected"), (id) => select(id)),
  why: new WhyList(byId("why"), (id) => lookAt(id)),
};
const measure = view && new Measure(view);
const robot = new Robot();
const robotPanel = new RobotPanel(robot, () => lists.found.refresh());
const partMeshes = new Meshes();
const libraryPanel = new LibraryPanel({
  onShow: (model, turn) => showModel(model, meshes, turn),
  onRename: (name, to) => changeLibrary(() => service.renameModel(name, to)),
  onRemove: (name) => changeLibrary(() => service.removeModel(name)),
});
const partsPanel = new PartsPanel({
  onShow: ({ model }, turn) => {
    partMeshes.setModels([model]);
    showModel(model, partMeshes, turn);
  },
  onPublished: () => loadLibrary(),
});
const liveStrip = new LiveStrip({
  onOpen: (kept, answer) => openScan(kept, null, answer),
  onFailed: (failed, reason) => showFailed(failed, reason),
});
const session = new SessionTab({
  open: (kept, answer) => openScan(kept, null, answer),
  parameters: (other) => settings.parameters(other),
  adopt: (other, camera) => settings.adopt(other, camera),
  fault: (other) => settings.fault(other),
  selected: () => selected,
  select: (id) => select(id),
  meshes,
  library: () => library,
});

let library = { unit: "m", models: [], generation: 0 };
let scoreParts = null;
let settings = null;
let limits = null; // of poses
let scan = null;
let points = null; // of the scan: { key, positions, total, viewpoint }
let running = null; // the AbortController of what is being asked
let shownThings = []; // what is drawn of the result
let rays = new Map(); // by thing, what they say of it, where that was asked
let selected = null;
const scrolled = new Map(); // how far, by tab
let tool = null; // what a click on the scan is for, but to select: see setTool

function makeView() {
  try {
    return new SceneView(byId("canvas"), byId("marks"));
  } catch {
    byId("no-webgl").hidden = false;
    byId("canvas").hidden = true;
    return null;
  }
}

// The texts of the panel.

function say(headline) {
  byId("headline").textContent = headline;
  document.title = scan ? `${headline} – ${scan.name} – Trivet` : "Trivet";
}

function setBusy(busy) {
  byId("progress").hidden = !busy;
  byId("result").setAttribute("aria-busy", busy);
}

/** action  { label, run } that may solve the problem, if any */
function showProblem(message, action) {
  byId("problem").replaceChildren(
    element("p", {}, message),
    action ? element("button", { type: "button", onclick: action.run }, action.label) : "",
  );
}

const tryAgain = (act) => ({ label: "Try again", run: act });

function clearResult() {
  selected = null;
  session.leave();
  if (byId("problem").contains(document.activeElement)) byId("headline").focus();
  for (const id of ["problem", "advice"]) byId(id).replaceChildren();
  for (const id of ["found", "rejected", "why", "times", "answer"]) byId(`${id}-section`).hidden = true;
  for (const list of Object.values(lists)) list.show([]);
  shownThings = [];
  rays = new Map();
  robotPanel.show(null);
  measure?.setThings([]);
  view?.setThings([]);
}

function tellScan(scene) {
  const facts = [
    scan.name,
    points && numbered(points.total, "point", "points"),
    points &&
      points.total > points.positions.length / 3 &&
      `${countWords(points.positions.length / 3)} drawn`,
    scene?.invalid_points > 0 && `${countWords(scene.invalid_points)} invalid`,
    points?.viewpoint && `sensor at ${placeWords(points.viewpoint, settings.unit)}`,
    scene?.noise > 0 && `noise ${lengthWords(scene.noise, settings.unit)}`,
    scene?.view?.words,
  ];
  byId("scan-facts").textContent = facts.filter(Boolean).slice(1).join(", ");
  byId("view-title").textContent = scan.name;
}

// Scans.

/**
 * answer  a kept answer, if there is one; otherwise the service is asked
 * linked  settings from the page's address, if it opens the scan
 */
function openScan(next, camera, answer = null, linked = null) {
  takeScan(next, camera);
  const asked = answer?.query ? settings.shown(new URLSearchParams(answer.query)) : linked;
  tellIgnored(asked ? settings.restore(asked) : []);
  showTab("result");
  return run(answer);
}

/** Makes another scan the current one, before any of it is shown. */
function takeScan(next, camera) {
  scan = next;
  points = null;
  measure?.setScan(null);
  limits.setPoints(null);
  view?.clear();
  byId("welcome").hidden = true;
  if (byId("examples-box").contains(document.activeElement)) byId("headline").focus();
  byId("examples-box").open = false;
  byId("recognize").disabled = false;
  settings.adopt(scan, camera);
}

/** Shows a failed scan of the watched folder as a result; nothing of another scan stays. */
function showFailed(failed, reason) {
  running?.abort();
  takeScan(failed, null);
  showTab("result");
  clearResult();
  showTools();
  setBusy(false);
  tellScan();
  say("Not recognized");
  showProblem(reason, tryAgain(() => run()));
}

async function openFiles(files) {
  if (partsPanel.allowed && !byId("models").hidden) return partsPanel.bring([...files]);
  try {
    const { scans, camera } = await readFiles(files);
    if (session.isKept && (scans.length > 1 || (scans.length && !byId("session").hidden))) {
      showTab("session");
      return await session.add(scans, camera);
    }
    if (scans.length > 1)
      throw new Error(`Expected one scan, found ${scans.length}: drop one at a time.`);
    if (scans.length) return await openScan(scans[0], camera);
    settings.setCamera(camera);
    if (scan && mayBeDepthImage(scan)) return await run();
    showProblem("The camera is kept for the next depth image.");
  } catch (error) {
    showTab("result");
    showProblem(error.message);
  }
}

/** Shows the scan as read by the service, unless it is already shown. */
async function showPoints(signal) {
  const parameters = settings.pointParameters(scan);
  const key = parameters.toString();
  if (points?.key === key) return;
  const fetched = await service.fetchPoints(scan, parameters, signal);
  points = { key, ...fetched };
  view?.showScan(points.positions, points.viewpoint ? beside(points.viewpoint) : [0, 0, 0]);
  measure?.setScan(points, settings.unit);
  limits.setPoints(points);
  showTools();
  byId("canvas").setAttribute("aria-label", `Scan ${scan.name}`);
  tellScan();
}

/**
 * Requests recognition of the scan with the current settings, or shows a kept answer; a pending
 * request is dropped.
 */
async function run(kept = null) {
  running?.abort();
  const asking = new AbortController();
  running = asking;
  clearResult();
  const fault = settings.fault(scan);
  settings.mark(fault);
  tellScan();
  setBusy(!fault);
  if (fault) {
    say("Settings are missing");
    return showProblem(fault.message);
  }
  say(kept ? "Opening …" : "Recognizing …");
  let shown = Promise.resolve();
  const parameters = settings.parameters(scan);
  showCommands(scan, parameters, library.library, settings.described);
  try {
    scan.body ??= await service.fetchBytes(scan.url, asking.signal);
    shown = showPoints(asking.signal);
    const [result] = await Promise.all([
      kept ? service.keptResult(kept) : service.recognize(scan, parameters, asking.signal),
      shown,
    ]);
    if (kept) session.enter(kept);
    await showResult(result, asking.signal);
    if (kept && !asking.signal.aborted) await session.show(kept);
  } catch (error) {
    await shown.catch(() => {}); // its points may tell why
    if (asking.signal.aborted) return;
    say(error instanceof service.ServiceError ? "Not recognized" : "Not shown");
    if (!proposeUnit()) showProblem(error.message, error.mayPass && tryAgain(() => run(kept)));
  } finally {
    if (running === asking) setBusy(false);
  }
}

/**
 * Proposes the other unit if the scan then matches the size of the models. Returns whether it does.
 */
function proposeUnit() {
  const found = unitThatFits(points?.positions, settings.unit, library);
  if (!found) return false;
  const { smallest, largest, fitting } = found;
  const across = Number(found.across.toPrecision(3));
  settings.markUnit();
  showProblem(
    `In ${settings.unit} the scan is ${across} ${settings.unit} across, the models ` +
      `${lengthWords(smallest, library.unit)} to ${lengthWords(largest, library.unit)}. ` +
      `It fits to them if its unit is ${fitting}: ${across} ${fitting} across.`,
    {
      label: `Read it in ${fitting}`,
      run: () => {
        settings.unit = fitting;
        run();
      },
    },
  );
  return true;
}

// Results.

async function showResult(result, signal) {
  const { answer } = result;
  const [scene] = answer.scenes;
  if (answer.library.generation !== library.generation) await loadLibrary();
  const { detections, rejected = [] } = scene;
  const colors = detectionColors(detections);
  const told = worthTelling(rejected, detections);
  const things = [
    ...detections.map((pose, k) => ({
      id: `found-${k}`,
      kind: "found",
      label: `${k + 1}`,
      color: colors[k],
      pose,
    })),
    ...told.map((pose, k) => ({
      id: `rejected-${k}`,
      kind: "rejected",
      label: `R${k + 1}`,
      pose,
      reason: rejectionWords(pose),
    })),
  ];

  say(
    detections.length
      ? `${detections.length} found in ${secondsWords(answer.seconds.work)}`
      : "No model found",
  );
  tellScan(scene);
  const kinds = {
    found: things.slice(0, detections.length),
    rejected: things.slice(detections.length),
  };
  const aboutPose = (pose) => robotPoseView(robot, pose, () => robotPanel.refresh());
  lists.found.show(kinds.found, { unit: settings.unit, scoreParts, aboutPose });
  lists.rejected.show(kinds.rejected, { unit: settings.unit, scoreParts });
  robotPanel.show({ scene: scan.name, unit: settings.unit, detections }, library.models);
  byId("found-section").hidden = !detections.length;
  byId("rejected-note").textContent = rejectedNote(rejected.length, told.length);
  showLayer("rejected", isShown("rejected"));
  byId("advice").replaceChildren(...adviceView(scene.advice ?? []));
  byId("times").replaceChildren(...timesView(answer, result.seconds));
  byId("times-section").hidden = false;
  showAnswer(result, scan.name);
  shownThings = things;
  await pose(things, signal);
}

/** Asks why models are found, or not, at a position of the scan as drawn. */
async function askWhy(place) {
  if (!shownThings.length && byId("times-section").hidden) return; // nothing is answered yet
  running?.abort();
  const asking = new AbortController();
  running = asking;
  const inScan = place.map((x, axis) => x + (points.offset[axis] ?? 0));
  byId("why-section").hidden = false;
  byId("why-note").textContent = `Looking at ${placeWords(inScan, settings.unit)} …`;
  lists.why.show([]);
  byId("why-section").scrollIntoView({ block: "nearest" });
  setBusy(true);
  try {
    const parameters = settings.parameters(scan);
    parameters.set("explain", inScan.join(","));
    showCommands(scan, parameters, library.library, settings.described);
    const { answer } = await service.recognize(scan, parameters, asking.signal);
    await showWhy(answer.scenes[0].explanation, asking.signal);
  } catch (error) {
    if (!asking.signal.aborted) byId("why-note").textContent = error.message;
  } finally {
    if (running === asking) setBusy(false);
  }
}

async function showWhy({ point, models }, signal) {
  const entries = models.map((explained, k) => {
    const found = explained.detection === null ? null : `found-${explained.detection}`;
    return { id: found ?? (explained.pose && `why-${k}`), explained };
  });
  byId("why-note").textContent =
    `At ${placeWords(point, settings.unit)}: ${verdictWords(models, settings.minScore)}`;
  lists.why.show(entries);
  rays = new Map(entries.map(({ id, explained }) => [id, explained.rays]));
  const drawn = entries
    .filter(({ id }) => id?.startsWith("why"))
    .map(({ id, explained }) => ({ id, kind: "why", label: "?", pose: explained.pose }));
  await pose([...shownThings, ...drawn], signal);
  lookAt(entries.find(({ id }) => id)?.id ?? null);
  byId("why-section").scrollIntoView({ block: "nearest" });
}

/** Shows the subject of a result row in the view, and leaves the other lists unchanged. */
function lookAt(id) {
  selected = id;
  lists.why.open(id);
  view?.showRays(rays.get(id) ?? null, points.offset);
  view?.select(id);
}

/** tool  the tool that picks positions in the scan: "ask", "ruler" or null */
function setTool(next) {
  tool = next;
  for (const other of ["ask", "ruler"]) byId(other).setAttribute("aria-pressed", other === next);
  byId("canvas").classList.toggle("asks", next !== null);
  byId("tool-hint").textContent = next ? kToolHints[next] : "";
  if (next) byId("canvas").focus({ preventScroll: true });
  if (view) view.asks = next !== null;
}

const toggleTool = (which) => view && setTool(tool === which ? null : which);

function takePlace(point) {
  if (tool === "ask") return askWhy(point);
  byId("measure-box").open = true;
  return measure.ruler.take(point);
}

/** Deselects the tool, or else the shown item. */
function letGo() {
  if (!tool) return select(null);
  if (tool === "ruler") measure.ruler.clear();
  return setTool(null);
}

function rejectedNote(all, told) {
  if (!all) return "No other pose was tested in full.";
  if (all === told) return "";
  return (
    `${numbered(all - told, "more scores", "more score")} next to nothing, or lie where a better ` +
    "pose of the same model was found."
  );
}

/** A position in the scan's frame as its points are drawn, which may have an offset. */
function beside(place) {
  return place.map((x, axis) => x - (points?.offset[axis] ?? 0));
}

/** The transform from a model's vertices, in the library's unit, to the points as drawn. */
function poseMatrix(rows) {
  const scale = unitScale(library.unit, settings.unit);
  return new Matrix4()
    .set(...rows.flat())
    .setPosition(...beside(rows.slice(0, 3).map((row) => row[3])))
    .scale(new Vector3().setScalar(scale));
}

/** Draws the posed models in the view. */
async function pose(things, signal) {
  if (!view) return;
  meshes.keep(new Set(things.map((thing) => thing.pose.model)));
  const drawn = await Promise.all(
    things.map(async (thing) => ({
      id: thing.id,
      kind: thing.kind,
      label: thing.label,
      name: thing.pose.model,
      color: thing.color,
      geometry: await meshes.get(thing.pose.model),
      pose: poseMatrix(thing.pose.T_scene_model),
      alternatives: (thing.pose.alternatives ?? []).map(poseMatrix),
    })),
  );
  if (signal.aborted) return;
  view.setThings(drawn);
  view.select(selected);
  const found = things.filter((thing) => thing.kind === "found");
  measure.setThings(drawn.filter((thing) => thing.kind === "found"));
  byId("canvas").setAttribute(
    "aria-label",
    `Scan ${scan.name} with ${numbered(found.length, "model", "models")} drawn in`,
  );
}

function select(id) {
  selected = id;
  for (const list of Object.values(lists)) list.open(id);
  view?.showRays(null);
  view?.select(id);
  measure?.follow(id);
}

// Layers of the view.

const isShown = (layer) => byId(`layer-${layer}`).getAttribute("aria-pressed") === "true";

function showLayer(layer, shown) {
  byId(`layer-${layer}`).setAttribute("aria-pressed", shown);
  view?.setLayers({ [layer]: shown });
  if (layer !== "rejected") return;
  byId("rejected-section").hidden = !shown || byId("times-section").hidden;
  if (!shown && selected?.startsWith("rejected")) select(null);
}

/** Shows the tools of the view if it is not empty, and those for scans if it shows a scan. */
function showTools(model = false) {
  byId("tools").hidden = !view || !(points || model);
  for (const layer of ["scan", "found", "rejected"]) byId(`layer-${layer}`).hidden = model;
  for (const other of ["ask", "ruler"]) byId(other).hidden = model;
  byId("limits").hidden = !view || !points || model;
  measure?.show(!model);
}

const toggleLayer = (layer) => showLayer(layer, !isShown(layer));

// The library.

async function loadLibrary() {
  library = await service.fetchLibrary();
  meshes.setModels(library.models);
  libraryPanel.show(library, partsPanel.allowed);
  partsPanel.models = library.models;
  settings?.takeModels(library.models);
  byId("library-facts").textContent =
    `${library.library}: ${numbered(library.models.length, "model", "models")}, ` +
    `generation ${library.generation}`;
}

/** Makes a change to the library and shows the outcome. */
async function changeLibrary(change) {
  try {
    await change();
    await loadLibrary();
  } catch (error) {
    byId("models-count").textContent = error.message;
  }
}

/** source  of its mesh; turn  a near symmetry, drawn over the model: see fetchNearTurnsOfModel */
async function showModel(model, source = meshes, turn = null) {
  try {
    const geometry = await source.get(model.name);
    if (byId("models").hidden) return;
    const axes = [
      ...model.symmetry.axes,
      ...model.near_symmetry.axes.map((axis) => ({ ...axis, near: true })),
    ];
    const turned = turn && {
      matrix: new Matrix4().set(...turn.measured.flat()),
      place: new Vector3(...turn.place),
    };
    const shownAxes = turn ? [{ ...turn.axis, near: true }] : axes;
    view?.showModel(geometry, kAloneColor, shownAxes, turned);
    libraryPanel.mark(model);
    showTools(true);
    byId("welcome").hidden = true;
    byId("view-title").textContent = turn
      ? `${model.name}, turned: ${lengthWords(turn.deviation.largest, library.unit)} off at the ball`
      : model.name;
  } catch (error) {
    byId("models-count").textContent = error.message;
  }
}

function showTab(name) {
  const panel = byId("panel");
  const before = ["result", "models", "session"].find((other) => !byId(other).hidden);
  if (before) scrolled.set(before, panel.scrollTop);
  for (const other of ["result", "models", "session"]) {
    byId(other).hidden = other !== name;
    byId(`tab-${other}`).setAttribute("aria-selected", other === name);
  }
  if (before !== name) panel.scrollTop = scrolled.get(name) ?? 0;
  if (name === "models") return;
  view?.closeModel();
  libraryPanel.mark(null);
  showTools();
  byId("welcome").hidden = Boolean(scan) || !view;
  byId("view-title").textContent = scan?.name ?? "";
}

// The rest of the page.

function listen() {
  listenForFiles(openFiles);
  byId("fit").onclick = () => view?.fit();
  for (const layer of ["scan", "found", "rejected"]) {
    byId(`layer-${layer}`).onclick = () => toggleLayer(layer);
  }
  for (const which of ["ask", "ruler"]) byId(which).onclick = () => toggleTool(which);
  byId("box").onclick = () => limits.toggleRegion();
  byId("tilt").onclick = () => limits.toggleTilt();
  for (const name of ["result", "models", "session"])
    byId(`tab-${name}`).onclick = () => showTab(name);
  moveByArrows(document.querySelector("[role=tablist]"), "[role=tab]");
  moveByArrows(byId("tools"), "button");
  moveByArrows(byId("limits"), "button");
  byId("show-help").onclick = () => byId("help").showModal();
  addEventListener("keydown", onShortcut);
  if (!view) return;
  view.onPick = (id) => select(id);
  view.onDraw = (lens) => limits.look(lens);
  view.onAsk = takePlace;
  byId("canvas").addEventListener("keydown", (event) => {
    const point = event.key === "Enter" && view.asks && view.pointInTheMiddle();
    if (point) takePlace(point);
  });
  view.onLook = (point, distance) => {
    const { unit } = settings;
    byId("look").textContent = point
      ? `looking at ${pointWords(point, unit)}, from ${lengthWords(distance, unit)}`
      : "";
  };
  view.onScale = (length) =>
    showScale(length, view.showsModel ? library.unit : settings.unit);
}

function onShortcut(event) {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  if (byId("help").open || event.target.matches("input, select, textarea")) return;
  const run_shortcut = {
    o: () => byId("files").click(),
    f: () => view?.fit(),
    s: () => toggleLayer("scan"),
    d: () => toggleLayer("found"),
    r: () => toggleLayer("rejected"),
    w: () => toggleTool("ask"),
    l: () => toggleTool("ruler"),
    v: () => liveStrip.toggle(),
    b: () => limits.toggleRegion(),
    t: () => limits.toggleTilt(),
    m: () => {
      const opens = byId("models").hidden;
      showTab(opens ? "models" : "result");
      if (opens) libraryPanel.focus();
      else byId("tab-result").focus();
    },
    e: () => {
      if (!session.isKept) return;
      showTab("session");
      session.focus();
    },
    y: () => session.mark(true),
    n: () => session.mark(false),
    a: () => session.markAll(),
    "?": () => byId("help").showModal(),
    Escape: letGo,
  }[event.key];
  if (!run_shortcut) return;
  event.preventDefault();
  run_shortcut();
}

/** Applies the settings in the page's address, and opens the example in it. */
function followLink(examples) {
  const { parameters, example: name } = readLink();
  const example = examples.find((one) => one.name === name);
  if (example && name !== scan?.name) return openScan(scanOfExample(example), null, null, parameters);
  const ignored = settings.restore(parameters);
  if (name && !example) ignored.push(`example: the service offers no “${name}”.`);
  tellIgnored(ignored);
  return scan && run();
}

async function start() {
  new Pulse().start();
  try {
    await partsPanel.start();
    await loadLibrary();
    partsPanel.unit = library.unit;
    scoreParts = await service.fetchScoreParts();
    await fetchWords();
    robotPanel.start();
    settings = new Settings(library, await service.fetchParameters());
    settings.onSubmit(() => run());
    limits = new Limits(settings);
    settings.onChange(() => {
      limits.show();
      writeLink(settings.shared(scan), scan);
    });
    listen();
    showTab("result");
    const examples = await showExamples((example) => openScan(scanOfExample(example)));
    await session.start();
    await liveStrip.start();
    say("Ready for a scan");
    addEventListener("hashchange", () => followLink(examples));
    followLink(examples);
  } catch (error) {
    say("Not ready");
    showProblem(
      error.message,
      tryAgain(() => location.reload()),
    );
  }
}

start();

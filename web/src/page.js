/** The start of the page: its parts are made, and connected to each other. */
import { byId, moveByArrows } from "./dom.js";
import { showExamples } from "./examples.js";
import { LibraryPanel } from "./library_panel.js";
import { Limits } from "./limits.js";
import { writeLink } from "./link.js";
import { LiveStrip } from "./live_strip.js";
import { Measure } from "./measure/measure.js";
import { listenForFiles } from "./open_files.js";
import { say, showProblem, tryAgain } from "./page/headline.js";
import { kLayers, toggleLayer } from "./page/layers.js";
import { changeLibrary, loadLibrary, showModel } from "./page/library.js";
import { followLink, openFiles, openScan, showFailedScan } from "./page/open_scan.js";
import { recognizeScan } from "./page/recognition.js";
import { lists, select } from "./page/selection.js";
import { onShortcut } from "./page/shortcuts.js";
import { meshes, state, view } from "./page/state.js";
import { kTabs, showTab } from "./page/tabs.js";
import { kTools, takePlace, toggleTool } from "./page/tools.js";
import { PartsPanel } from "./parts_panel.js";
import { Pulse } from "./pulse.js";
import { Robot } from "./robot/robot.js";
import { RobotPanel } from "./robot/robot_panel.js";
import { showScale } from "./scale_bar.js";
import { scanOfExample } from "./scan.js";
import * as service from "./service.js";
import { SessionTab } from "./session/session_tab.js";
import { Settings } from "./settings.js";
import { Meshes } from "./view/meshes.js";
import { fetchWords } from "./vocabulary.js";
import { lengthWords, pointWords } from "./words.js";

const openKept = (kept, answer) => openScan(kept, null, answer);

function makePartsPanel() {
  const partMeshes = new Meshes();
  return new PartsPanel({
    onShow: ({ model }, turn) => {
      partMeshes.setModels([model]);
      showModel(model, partMeshes, turn);
    },
    onPublished: () => loadLibrary(),
  });
}

function makeSession() {
  return new SessionTab({
    open: openKept,
    parameters: (other) => state.settings.parameters(other),
    adopt: (other, camera) => state.settings.adopt(other, camera),
    fault: (other) => state.settings.fault(other),
    selected: () => state.selected,
    select: (id) => select(id),
    meshes,
    library: () => state.library,
  });
}

function makePanels() {
  const robot = new Robot();
  return {
    robot,
    measure: view && new Measure(view),
    robotPanel: new RobotPanel(robot, () => lists.found.refresh()),
    libraryPanel: new LibraryPanel({
      onShow: (model, turn) => showModel(model, meshes, turn),
      onRename: (name, to) => changeLibrary(() => service.renameModel(name, to)),
      onRemove: (name) => changeLibrary(() => service.removeModel(name)),
    }),
    partsPanel: makePartsPanel(),
    liveStrip: new LiveStrip({ onOpen: openKept, onFailed: showFailedScan }),
    session: makeSession(),
  };
}

function listenToButtons() {
  byId("fit").onclick = () => view?.fit();
  for (const layer of kLayers) byId(`layer-${layer}`).onclick = () => toggleLayer(layer);
  for (const which of kTools) byId(which).onclick = () => toggleTool(which);
  byId("box").onclick = () => state.limits.toggleRegion();
  byId("tilt").onclick = () => state.limits.toggleTilt();
  for (const name of kTabs) byId(`tab-${name}`).onclick = () => showTab(name);
  moveByArrows(document.querySelector("[role=tablist]"), "[role=tab]");
  moveByArrows(byId("tools"), "button");
  moveByArrows(byId("limits"), "button");
  byId("show-help").onclick = () => byId("help").showModal();
}

function listenToView() {
  view.onPick = (id) => select(id);
  view.onDraw = (lens) => state.limits.look(lens);
  view.onAsk = takePlace;
  byId("canvas").addEventListener("keydown", (event) => {
    const point = event.key === "Enter" && view.asks && view.pointInTheMiddle();
    if (point) takePlace(point);
  });
  view.onLook = (point, distance) => {
    const { unit } = state.settings;
    byId("look").textContent = point
      ? `looking at ${pointWords(point, unit)}, from ${lengthWords(distance, unit)}`
      : "";
  };
  view.onScale = (length) =>
    showScale(length, view.showsModel ? state.library.unit : state.settings.unit);
}

async function makeSettings() {
  const settings = new Settings(state.library, await service.fetchParameters());
  state.settings = settings;
  settings.onSubmit(() => recognizeScan());
  state.limits = new Limits(settings);
  settings.onChange(() => {
    state.limits.show();
    writeLink(settings.shared(state.scan), state.scan);
  });
}

function listen() {
  listenForFiles(openFiles);
  listenToButtons();
  addEventListener("keydown", onShortcut);
  if (view) listenToView();
}

async function start() {
  new Pulse().start();
  state.panels = makePanels();
  const { partsPanel, robotPanel, session, liveStrip } = state.panels;
  try {
    await partsPanel.start();
    await loadLibrary();
    partsPanel.unit = state.library.unit;
    state.scoreParts = await service.fetchScoreParts();
    await fetchWords();
    robotPanel.start();
    await makeSettings();
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

import { byId } from "./dom.js";
import { kAccepted } from "./scan.js";

/** Calls `open(files)` for files that are selected, or dropped anywhere on the page. */
export function listenForFiles(open) {
  const chooser = byId("files");
  chooser.accept = kAccepted;
  chooser.addEventListener("change", () => {
    if (chooser.files.length) open(chooser.files);
    // The same file can then be chosen again.
    chooser.value = "";
  });
  for (const id of ["open", "choose"]) byId(id).addEventListener("click", () => chooser.click());

  const holdsFiles = (event) => event.dataTransfer?.types.includes("Files");
  const mark = (dragging) => byId("drop-here").classList.toggle("shown", dragging);
  addEventListener("dragover", (event) => {
    if (!holdsFiles(event)) return;
    event.preventDefault();
    event.dataTransfer.dropEffect = "copy";
    mark(true);
  });
  addEventListener("dragleave", (event) => {
    // Without a related target the pointer has left the window.
    if (!event.relatedTarget) mark(false);
  });
  addEventListener("drop", (event) => {
    if (!holdsFiles(event)) return;
    event.preventDefault();
    mark(false);
    open(event.dataTransfer.files);
  });
}

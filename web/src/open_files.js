import { byId } from "./dom.js";
import { kAccepted } from "./scan.js";

/** Calls `open(files)` for files that are selected, or dropped anywhere on the page. */
export function listenForFiles(open) {
  const chooser = byId("files");
  chooser.accept = kAccepted;
  chooser.addEventListener("change", () => {
    if (chooser.files.length) open(chooser.files);
    chooser.value = ""; // so that the same file can be chosen again
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
    if (!event.relatedTarget) mark(false); // out of the window
  });
  addEventListener("drop", (event) => {
    if (!holdsFiles(event)) return;
    event.preventDefault();
    mark(false);
    open(event.dataTransfer.files);
  });
}

import { curlCommand, pythonCall, trivetCommand } from "./commands.js";
import { copiesOnClick } from "./copy.js";
import { byId } from "./dom.js";

const kWriters = {
  trivet: trivetCommand,
  curl: (scan, parameters) => curlCommand(scan, parameters, location.origin),
  python: pythonCall,
};

/**
 * Shows commands that make the same request without the page.
 *
 * parameters  of the request; described  descriptions of all parameters by name
 * library     file name
 */
export function showCommands(scan, parameters, library, described) {
  const show = () => {
    const text = kWriters[byId("command-kind").value](scan, parameters, library, described);
    byId("command").textContent = text;
    byId("copy-command").textContent = "Copy";
    copiesOnClick(byId("copy-command"), text);
  };
  byId("command-kind").onchange = show;
  show();
  byId("command-box").hidden = false;
}

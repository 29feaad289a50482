/** What is set, and the scan if the service offers it, in the address of the page. */
import { copiesOnClick } from "./copy.js";
import { byId } from "./dom.js";

const kExample = "example";
const kExamples = "/v1/examples/"; // where scans are that every visitor of the service has
const kPauseSeconds = 0.3; // browsers refuse many changes of the address in a short time

let writing = 0;

/** Returns { parameters: for Settings.restore, example: name, or null }. */
export function readLink() {
  const parameters = new URLSearchParams(location.hash.slice(1));
  const example = parameters.get(kExample);
  parameters.delete(kExample);
  return { parameters, example };
}

/** parameters  of Settings.shared; scan  or null */
export function writeLink(parameters, scan) {
  const isExample = scan?.url?.startsWith(kExamples) ?? false;
  const all = new URLSearchParams(isExample ? [[kExample, scan.name], ...parameters] : parameters);
  const hash = all.toString().replaceAll("%2C", ",").replaceAll("%2F", "/");
  const address = location.pathname + location.search + (hash && `#${hash}`);
  clearTimeout(writing);
  writing = setTimeout(() => history.replaceState(null, "", address), 1000 * kPauseSeconds);
  byId("copy-link").textContent = "Copy link";
  copiesOnClick(byId("copy-link"), location.origin + address);
  byId("link-note").textContent =
    scan && !isExample
      ? `The link holds what is set here. ${scan.name} is a file of yours: whoever opens the link ` +
        "has to open it, too."
      : `The link holds what is set here${isExample ? " and the scan" : ""}.`;
}

/** Tell what a link says that cannot be done; none: it is fine. */
export function tellIgnored(sentences) {
  const note = byId("link-ignored");
  note.hidden = !sentences.length;
  note.textContent = sentences.length ? `Of the link was ignored: ${sentences.join(" ")}` : "";
}

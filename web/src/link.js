/** The settings, and the scan if it is an example, in the address of the page. */
import { copiesOnClick } from "./copy.js";
import { byId } from "./dom.js";
import { isExample } from "./scan.js";

const kExample = "example";
// Browsers refuse many changes of the address in a short time.
const kPauseSeconds = 0.3;

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
  const isOffered = isExample(scan);
  const all = new URLSearchParams(isOffered ? [[kExample, scan.name], ...parameters] : parameters);
  const hash = all.toString().replaceAll("%2C", ",").replaceAll("%2F", "/");
  const address = location.pathname + location.search + (hash && `#${hash}`);
  clearTimeout(writing);
  writing = setTimeout(() => history.replaceState(null, "", address), 1000 * kPauseSeconds);
  byId("copy-link").textContent = "Copy link";
  copiesOnClick(byId("copy-link"), location.origin + address);
  byId("link-note").textContent =
    scan && !isOffered
      ? `The link holds what is set here. ${scan.name} is not in it: whoever opens the link has to ` +
        "open the scan, too."
      : `The link holds what is set here${isOffered ? " and the scan" : ""}.`;
}

/** Shows which parts of a link cannot be applied; none: hides the message. */
export function tellIgnored(sentences) {
  const note = byId("link-ignored");
  note.hidden = !sentences.length;
  note.textContent = sentences.length ? `Of the link was ignored: ${sentences.join(" ")}` : "";
}

/**
 * Let a link download a text.
 *
 * scan  the name of the scan that it is about, which may have folders and an ending
 * end   of the file's name
 */
export function downloadsText(link, text, type, scan, end) {
  URL.revokeObjectURL(link.href);
  link.href = URL.createObjectURL(new Blob([text], { type }));
  link.removeAttribute("aria-disabled");
  link.download = `${scan.replace(/^.*\//, "").replace(/\.[^.]*$/, "")}.${end}`;
}

/** Let a link download nothing until there is a text again. */
export function withholdsText(link) {
  URL.revokeObjectURL(link.href);
  link.removeAttribute("href");
  link.setAttribute("aria-disabled", "true");
}

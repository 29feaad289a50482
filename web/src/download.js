/**
 * Makes a link download a text.
 *
 * scan  the name of the related scan, which may have folders and an extension
 * end   the end of the file name
 */
export function downloadsText(link, text, type, scan, end) {
  URL.revokeObjectURL(link.href);
  link.href = URL.createObjectURL(new Blob([text], { type }));
  link.removeAttribute("aria-disabled");
  link.download = `${scan.replace(/^.*\//, "").replace(/\.[^.]*$/, "")}.${end}`;
}

/** Disables a download link until it has a text again. */
export function withholdsText(link) {
  URL.revokeObjectURL(link.href);
  link.removeAttribute("href");
  link.setAttribute("aria-disabled", "true");
}

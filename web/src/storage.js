/** What the page remembers for the next visit; nothing where the browser gives no storage. */

/** The text that was kept under this name, or null. */
export function recall(name) {
  try {
    return localStorage.getItem(name);
  } catch {
    return null;
  }
}

export function keep(name, text) {
  try {
    localStorage.setItem(name, text);
  } catch {
    // No storage: the next visit starts anew.
  }
}

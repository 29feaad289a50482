/** Storage of the page for the next visit; empty where the browser provides none. */

/** The text stored under this name, or null. */
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

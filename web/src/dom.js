/** The element of the page with this id. */
export const byId = (id) => document.getElementById(id);

/**
 * Creates an element.
 *
 * properties  of the element (`className`, `onclick`, …); a name with a dash is an attribute
 * children    elements or texts; null, undefined and false are omitted
 */
export function element(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name.includes("-") || name === "role") made.setAttribute(name, value);
    else made[name] = value;
  }
  made.append(...children.flat().filter((child) => child || child === 0 || child === ""));
  return made;
}

/** Terms and their definitions, as rows of a `dl`. */
export const terms = (entries) =>
  element(
    "dl",
    { className: "terms" },
    entries
      .filter(Boolean)
      .map(([term, value]) =>
        element("div", {}, element("dt", {}, term), element("dd", {}, value)),
      ),
  );

/**
 * Lets the arrow keys, Home and End move the focus along a list, which is then a single Tab stop.
 *
 * list      remains; its items may change
 * selector  matches the focusable elements
 */
export function moveByArrows(list, selector) {
  const items = () => [...list.querySelectorAll(selector)].filter((item) => item.offsetParent);
  const settle = () => {
    const all = list.querySelectorAll(selector);
    const current = list.querySelector(`${selector}[tabindex="0"]`) ?? all[0];
    for (const item of all) item.tabIndex = item === current ? 0 : -1;
  };
  new MutationObserver(settle).observe(list, { childList: true, subtree: true });
  settle();
  list.addEventListener("focusin", ({ target }) => {
    if (!target.matches(selector)) return;
    for (const item of list.querySelectorAll(selector)) item.tabIndex = item === target ? 0 : -1;
  });
  list.addEventListener("keydown", (event) => {
    const all = items();
    const at = all.indexOf(event.target);
    if (at < 0) return;
    const to = {
      ArrowDown: at + 1,
      ArrowRight: at + 1,
      ArrowUp: at - 1,
      ArrowLeft: at - 1,
      Home: 0,
      End: all.length - 1,
    }[event.key];
    if (to === undefined) return;
    event.preventDefault();
    all[Math.min(Math.max(to, 0), all.length - 1)].focus();
  });
}

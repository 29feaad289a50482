import { element } from "./dom.js";

/**
 * A fallback for pages that are neither local nor encrypted, where browsers provide no clipboard.
 */
function copySelected(text) {
  const focused = document.activeElement;
  const field = element("textarea", { className: "unseen", value: text, readOnly: true });
  document.body.append(field);
  field.select();
  const copied = document.execCommand("copy");
  field.remove();
  focused?.focus();
  if (!copied) throw new Error("the browser refused");
}

async function copy(text) {
  if (!navigator.clipboard) return copySelected(text);
  return navigator.clipboard.writeText(text);
}

/** Makes a button copy a text and show whether it succeeded. */
export function copiesOnClick(button, text) {
  const label = button.textContent;
  button.onclick = async () => {
    try {
      await copy(text);
      button.textContent = "Copied";
    } catch {
      button.textContent = "Not copied: the browser refused";
      setTimeout(() => (button.textContent = label), 3000);
    }
  };
  return button;
}

export const copyButton = (label, text) =>
  copiesOnClick(element("button", { type: "button" }, label), text);

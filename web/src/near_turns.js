/** The near symmetries of a model, one by one, with their deviations. */
import { element } from "./dom.js";
import { axisWords, lengthWords, nearSymmetryWords, orientationOf, turnWords } from "./words.js";

// Digits of the numbers of a declaration, which were floats.
const kDigits = 7;

/** "180.0° about 0.00, 0.00, 1.00", or any rotation about the axis. */
export function nearTurnWords({ motions, axis }) {
  if (motions.length) return turnWords(orientationOf(motions[0]));
  return `any angle about ${axisWords(axis.direction)}`;
}

/** The deviation of a model from itself after a rotation. unit  of the library */
export function deviationWords({ deviation: { median, p90, largest } }, unit) {
  const words = (length) => lengthWords(length, unit);
  return (
    `up to ${words(largest)} off itself; a tenth of the surface by more than ${words(p90)}, ` +
    `half of it by more than ${words(median)}`
  );
}

const roundedNumbers = (json) =>
  JSON.parse(JSON.stringify(json), (_, value) =>
    typeof value === "number" ? Number(value.toPrecision(kDigits)) : value,
  );

/** The declared symmetries of a model with one near symmetry added, in the form of a manifest. */
export function declarationWith({ symmetry }, { motions, axis }) {
  const declared = symmetry.declaration ?? { symmetries: [] };
  const { direction, point } = axis;
  return roundedNumbers(
    motions.length
      ? { ...declared, symmetries: [...declared.symmetries, ...motions] }
      : { ...declared, symmetry_axis: { axis: direction, offset: point } },
  );
}

function turnRow(turn, { unit, onShow, actionOf }) {
  return element(
    "li",
    {},
    element("p", {}, `Turned by ${nearTurnWords(turn)}`),
    element("p", { className: "dim" }, `${deviationWords(turn, unit)}.`),
    element(
      "p",
      { className: "buttons" },
      element("button", { type: "button", onclick: () => onShow(turn) }, "Show this turn"),
      actionOf(turn),
    ),
  );
}

/**
 * A list that opens on demand; null if there are no near symmetries.
 *
 * model    { near_symmetry, … }
 * words    purpose of the list
 * handlers { fetchTurns(): promises the near symmetries, unit: of the library, onShow(turn): draws
 * one, actionOf(turn): an element that declares it }
 */
export function nearTurnsView({ near_symmetry: near }, words, handlers) {
  if (!near.declaration) return null;
  const list = element("ul", {});
  const status = element("p", { className: "dim", role: "status" });
  const fill = async () => {
    status.textContent = "Measuring how far off each turn is …";
    try {
      const turns = await handlers.fetchTurns();
      list.replaceChildren(...turns.map((turn) => turnRow(turn, handlers)));
      status.textContent = "";
    } catch (error) {
      status.textContent = error.message;
    }
  };
  return element(
    "details",
    {
      className: "near",
      ontoggle: ({ target }) => target.open && !list.childElementCount && fill(),
    },
    element("summary", {}, nearSymmetryWords(near)),
    element("p", { className: "dim" }, words),
    status,
    list,
  );
}

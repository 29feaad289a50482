import { element } from "../dom.js";
import { wordsOf } from "../vocabulary.js";

/** The selectable conventions, as options of a `select`. */
export const conventionOptions = () =>
  Object.entries(wordsOf("robot_conventions")).map(([value, label]) =>
    element("option", { value }, label),
  );

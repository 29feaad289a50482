import { element } from "../dom.js";
import { kConventions } from "./conventions.js";

/** The selectable conventions, as options of a `select`. */
export const conventionOptions = () =>
  Object.entries(kConventions).map(([value, { label }]) => element("option", { value }, label));

import { element } from "../dom.js";
import { kConventions } from "./conventions.js";

/** Conventions to choose one of, for a `select`. */
export const conventionOptions = () =>
  Object.entries(kConventions).map(([value, { label }]) => element("option", { value }, label));

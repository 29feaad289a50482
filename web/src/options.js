import { element } from "./dom.js";

// What the form asks for by other fields, or the page by itself.
const kElsewhere = ["format", "camera", "viewpoint", "unit", "rejected", "claims"];

const optionElements = (names) => names.map((name) => element("option", { value: name }, name));

/** A field for a parameter as the service describes it; it shows the default. */
function fieldFor({ name, schema }) {
  const usual = schema.default ?? "";
  if (schema.enum) {
    const select = element("select", { name }, optionElements(schema.enum));
    select.value = usual;
    return select;
  }
  if (schema.type === "boolean") return element("input", { name, type: "checkbox" });
  if (schema.type === "array") {
    const placeholder = schema.items.enum ? "a, b, …" : schema.minItems ? "x, y, …" : "all";
    return element("input", { name, type: "text", autocomplete: "off", placeholder });
  }
  return element("input", {
    name,
    type: "number",
    min: schema.minimum ?? schema.exclusiveMinimum ?? "",
    max: schema.maximum ?? "",
    step: schema.type === "integer" ? 1 : "any",
    placeholder: usual,
  });
}

/** What a field says in a request; null: what the service takes without being told. */
function valueOf(field) {
  if (field.type === "checkbox") return field.checked ? "true" : null;
  const text = field.value.replaceAll(" ", "");
  return text === "" || text === field.dataset.usual ? null : text;
}

/** The options of a recognition that the form has no field of its own for. */
export class Options {
  #fields = [];

  /**
   * form        has fields for some parameters, which take choices, range and default from here
   * box         where fields for the others go
   * parameters  of /v1/recognize, from the service's description
   */
  constructor(form, box, parameters) {
    for (const parameter of parameters) {
      if (parameter.in !== "query" || kElsewhere.includes(parameter.name)) continue;
      const made = fieldFor(parameter);
      made.dataset.usual = made.value;
      const known = form.elements[parameter.name];
      if (known) {
        if (known.required) made.value = made.placeholder;
        made.required = known.required;
        known.replaceWith(made);
        continue;
      }
      this.#fields.push(made);
      const name = parameter.name.replaceAll("-", " ");
      box.append(element("label", { title: parameter.description }, name, made));
    }
  }

  /** [name, value] of each that was changed. */
  changed() {
    return this.#fields
      .map((field) => [field.name, valueOf(field)])
      .filter(([, value]) => value !== null);
  }
}

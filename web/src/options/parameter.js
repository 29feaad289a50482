/** Parameters of a request, as described by the service; values are texts, as in a query. */

/** "number", "integer", "boolean", "choice", "numbers" or "names" */
export function kindOf({ schema }) {
  if (schema.enum) return "choice";
  if (schema.type !== "array") return schema.type;
  return schema.items.type === "number" ? "numbers" : "names";
}

/** "Radius of pairs [diameter]" */
export function labelOf(parameter) {
  const { "x-label": label, "x-unit": unit } = parameter;
  return label[0].toUpperCase() + label.slice(1) + (unit ? ` [${unit}]` : "");
}

/** The default of a parameter, as a text; "": usualWords describes it. */
export const usualOf = ({ schema }) => String(schema.default ?? "");

/** "all", "2 to 7, by the scan's noise", …: the meaning of an unset value. */
export const usualWords = ({ description }) => description.match(/Absent: (.*)\.$/)?.[1] ?? "none";

export const isNumber = (text) => text.trim() !== "" && Number.isFinite(Number(text));

/** "above 0 to 1", "at least 1"; empty: any number */
function rangeWords({ minimum, exclusiveMinimum, maximum }) {
  const low = exclusiveMinimum === undefined ? minimum : `above ${exclusiveMinimum}`;
  if (low === undefined) return maximum === undefined ? "" : `at most ${maximum}`;
  if (maximum !== undefined && maximum < 2 ** 32 - 1) return `${low} to ${maximum}`;
  return exclusiveMinimum === undefined ? `at least ${low}` : low;
}

function expectedOfNumber(schema, text) {
  const value = Number(text);
  const whole = schema.type === "integer";
  const fits =
    isNumber(text) &&
    (!whole || Number.isInteger(value)) &&
    value >= (schema.minimum ?? -Infinity) &&
    value > (schema.exclusiveMinimum ?? -Infinity) &&
    value <= (schema.maximum ?? Infinity);
  return fits ? null : `a${whole ? " whole" : ""} number ${rangeWords(schema)}`.trim();
}

function expectedOfNumbers({ minItems, maxItems }, text) {
  const numbers = text.split(",");
  const fits = numbers.length >= minItems && numbers.length <= maxItems && numbers.every(isNumber);
  return fits ? null : `${minItems}${maxItems > minItems ? ` to ${maxItems}` : ""} numbers`;
}

/**
 * The fault of a value, as a sentence; null: none.
 *
 * names  the allowed names of a list
 */
export function faultOf(parameter, text, names = []) {
  const { schema } = parameter;
  const oneOf = (choices, value) => (choices.includes(value) ? null : `one of ${choices.join(", ")}`);
  const expected = {
    choice: () => oneOf(schema.enum, text),
    boolean: () => oneOf(["true", "false"], text),
    number: () => expectedOfNumber(schema, text),
    integer: () => expectedOfNumber(schema, text),
    numbers: () => expectedOfNumbers(schema, text),
    names: () => text.split(",").reduce((found, name) => found ?? oneOf(names, name), null),
  }[kindOf(parameter)]();
  return expected && `${labelOf(parameter)}: expected ${expected}, found “${text}”.`;
}

/** The effect of a parameter, and its range. */
export function helpOf(parameter) {
  const range = rangeWords(parameter.schema);
  const unit = parameter["x-unit"];
  // The label has the unit.
  const help = parameter.description
    .replace(unit ? ` [${unit}]` : "", "")
    .replace(/Absent: (?=[^:]*$)/, "Default: ");
  return range ? `${help} ${range[0].toUpperCase()}${range.slice(1)}.` : help;
}

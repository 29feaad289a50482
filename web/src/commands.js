/** The request in other forms: as a command, for curl, as a call in Python. */
import { kCameraKeys, kImageParameters } from "./scan.js";
import { kindOf } from "./options/parameter.js";

const kContentTypes = {
  png: "image/png",
  tif: "image/tiff",
  tiff: "image/tiff",
  ply: "model/ply",
  obj: "model/obj",
  stl: "model/stl",
  glb: "model/gltf-binary",
  gltf: "model/gltf+json",
};
const kServiceOnly = ["format", "rejected"];

/** A text quoted as one word of a POSIX shell. */
export const quoted = (text) =>
  /^[\w@%+=:,./-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`;

/**
 * A file name that is not parsed as an option or as standard input; kept scans have no extension.
 */
function fileName(name, format = "") {
  const ends = !format || name.toLowerCase().includes(`.${format}`);
  return `${name.startsWith("-") ? "./" : ""}${name}${ends ? "" : `.${format}`}`;
}

/**
 * scan        { name, format }
 * parameters  as sent
 * origin      of the service
 */
export function curlCommand(scan, parameters, origin) {
  const query = parameters.toString().replaceAll("%2C", ",");
  const type = kContentTypes[scan.format] ?? "application/octet-stream";
  return [
    `curl ${quoted(`${origin}/v1/recognize?${query}`)}`,
    `-H ${quoted(`Content-Type: ${type}`)}`,
    `--data-binary ${quoted(`@${fileName(scan.name, scan.format)}`)}`,
  ].join(" \\\n  ");
}

/** The camera of a request in the form of a camera file. */
function cameraOf(parameters) {
  const numbersOf = (name) => parameters.get(name)?.split(",").map((number) => Number(number || 1));
  const numbers = numbersOf("camera");
  const camera = Object.fromEntries(kCameraKeys.map((key, k) => [key, numbers[k] ?? 1]));
  if (parameters.has("depth")) camera.depth = parameters.get("depth");
  if (parameters.has("distortion")) camera.distortion = numbersOf("distortion");
  const size = numbersOf("image-size");
  if (size) [camera.width, camera.height] = size;
  return camera;
}

/** The parameters that do not concern the service alone: [name, value]. */
const elsewhere = (parameters) =>
  [...parameters].filter(([name]) => !kServiceOnly.includes(name));

/** library  file name; described  descriptions of the parameters by name */
export function trivetCommand(scan, parameters, library, described) {
  const lines = [`trivet recognize ${quoted(fileName(library))} ${quoted(fileName(scan.name, scan.format))}`];
  let before = "";
  for (const [name, value] of elsewhere(parameters)) {
    // These are among the numbers of the camera.
    if (kImageParameters.includes(name)) continue;
    if (name === "camera") {
      const file = "scan_camera.json";
      before = `echo ${quoted(JSON.stringify(cameraOf(parameters)))} > ${file}\n`;
      lines.push(`--camera ${file}`);
    } else if (kindOf(described.get(name)) === "boolean") lines.push(`--${name}`);
    else lines.push(`--${name}${value.startsWith("-") ? "=" : " "}${quoted(value)}`);
  }
  return before + [...lines, "--json -"].join(" \\\n  ");
}

const pythonNumber = (text) => String(Number(text));
const pythonText = (text) => JSON.stringify(text);
const kPython = {
  boolean: (text) => (text === "true" ? "True" : "False"),
  choice: pythonText,
  number: pythonNumber,
  integer: pythonNumber,
  numbers: (text) => `(${text.split(",").map(pythonNumber).join(", ")})`,
  names: (text) => `[${text.split(",").map(pythonText).join(", ")}]`,
};

export function pythonCall(scan, parameters, library, described) {
  const words = [];
  for (const [name, value] of elsewhere(parameters)) {
    // These are among the numbers of the camera.
    if (kImageParameters.includes(name)) continue;
    if (name === "camera") {
      const { depth_scale, ...camera } = cameraOf(parameters);
      const isPinhole = !kImageParameters.some((image) => parameters.has(image));
      const numbers = `(${Object.values(camera).join(", ")})`;
      words.push(`camera=${isPinhole ? numbers : JSON.stringify(camera)}`);
      words.push(`depth_scale=${depth_scale}`);
      continue;
    }
    words.push(`${name.replaceAll("-", "_")}=${kPython[kindOf(described.get(name))](value)}`);
  }
  return [
    "import trivet",
    "",
    `library = trivet.Library(${pythonText(library)})`,
    `result = library.recognize(${pythonText(scan.name)},`,
    ...words.map((word, k) => `    ${word}${k + 1 < words.length ? "," : ")"}`),
  ].join("\n");
}

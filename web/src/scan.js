/** Files that a user opens: scans, and camera files with them. */

const kDepthFormats = ["png", "tif", "tiff"];
const kCloudFormats = ["ply", "pcd", "obj", "stl", "off", "xyz", "asc", "pts", "txt", "csv", "glb"];
const kFormats = [...kCloudFormats, ...kDepthFormats, "npy"];
/** Formats of files for training models. */
export const kPartFormats = [...kCloudFormats, "gltf", "step", "stp", "gz"];
export const kAccepted = [...kFormats, "gz", "json"].map((format) => `.${format}`).join(",");

/** Whether a scan is a depth image, which needs its camera. */
export const isDepthImage = ({ format }) => kDepthFormats.includes(format);

/** Whether it may be a depth image: an array of numbers is one if it has a camera. */
export const mayBeDepthImage = (scan) => isDepthImage(scan) || scan.format === "npy";

export const kCameraKeys = ["fx", "fy", "cx", "cy", "depth_scale"];
/** The properties of a camera's images, as parameters of a request. */
export const kImageParameters = ["depth", "distortion", "image-size"];

/** The extension of the content, if the file is compressed by gzip. */
function extension(name) {
  const unpacked = name.toLowerCase().replace(/\.gz$/, "");
  return unpacked.slice(unpacked.lastIndexOf(".") + 1);
}

async function readCamera(file) {
  let camera;
  try {
    camera = JSON.parse(await file.text());
  } catch {
    throw new Error(`${file.name}: expected a camera in JSON, found something else.`);
  }
  const missing = kCameraKeys.filter((key) => !Number.isFinite(camera?.[key]));
  if (missing.length === kCameraKeys.length) {
    throw new Error(
      `${file.name}: expected a camera, with the numbers ${kCameraKeys.join(", ")}. Hand-eye ` +
        'calibrations and grasps are chosen below the result, under "For a robot".',
    );
  }
  if (missing.length) {
    throw new Error(
      `${file.name}: expected the numbers ${kCameraKeys.join(", ")}; ` +
        `missing: ${missing.join(", ")}.`,
    );
  }
  return {
    ...Object.fromEntries(kCameraKeys.map((key) => [key, String(camera[key])])),
    image: readImage(file.name, camera),
  };
}

/** Every property of a camera must be sent: an omitted distortion would give a wrong pose. */
function readImage(name, { depth, distortion, width, height, ...camera }) {
  const unknown = Object.keys(camera).filter((key) => !kCameraKeys.includes(key) && key[0] !== "_");
  if (unknown.length) {
    throw new Error(
      `${name}: ${unknown.join(", ")}: the page reads ${kCameraKeys.join(", ")}, depth, ` +
        "distortion, width and height; trivet recognize --camera reads other programs' files.",
    );
  }
  const image = {};
  if (depth && depth !== "z") image.depth = String(depth);
  if (distortion?.some((number) => number !== 0)) image.distortion = distortion.join(",");
  if (width && height) image["image-size"] = `${width},${height}`;
  return image;
}

/**
 * Reads dropped or selected files.
 *
 * Returns { scans: [{ name, format, body, query }], camera: or null }. Errors: neither scans of a
 *   known format nor a camera, a camera file without the numbers.
 */
export async function readFiles(files) {
  const all = [...files];
  const scans = all.filter((file) => kFormats.includes(extension(file.name)));
  const cameras = all.filter((file) => extension(file.name) === "json");
  if (!scans.length && !cameras.length) {
    throw new Error(
      `${all[0]?.name ?? "The drop"}: expected a scan (${kFormats.join(", ")}), and for a depth ` +
        "image a camera file (json).",
    );
  }
  const camera = cameras.length ? await readCamera(cameras[0]) : null;
  const scanOf = (file) => ({
    name: file.name,
    format: extension(file.name),
    body: file,
    query: null,
  });
  return { scans: scans.map(scanOf), camera };
}

// Every visitor of the service has the scans at these addresses.
const kExamples = "/v1/examples/";

/** Whether the scan is an example, available to every visitor of the service. */
export const isExample = (scan) => scan?.url?.startsWith(kExamples) ?? false;

/** An example scan of the service; its body still has to be fetched from `url`. */
export function scanOfExample({ name, query, url }) {
  const parameters = new URLSearchParams(query);
  return { name, format: parameters.get("format"), body: null, query: parameters, url };
}

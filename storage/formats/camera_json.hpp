/// Cameras as JSON: in manifests, files and requests, and in the formats of other programs.
#pragma once

#include <nlohmann/json.hpp>

#include "storage/data/cloud.hpp"
#include "storage/files/json_file.hpp"

namespace trivet {

/// Parses a camera in any of these forms. Everything that a form states is applied or refused,
/// never ignored:
/// - {"fx", "fy", "cx", "cy"}; RealSense calls the last two "ppx" and "ppy"
/// - {"cam_K": 9 numbers by rows} and {"cam_model": a pinhole camera} of BOP
/// - {"k" or "K": 9 numbers by rows} of ROS's CameraInfo, {"camera_matrix": {"data": ...}} of its
///   calibrations
/// - {"intrinsic_matrix": 9 numbers by columns} of Open3D, on its own or as "intrinsic"
///
/// Each form may have "depth_scale" (1 if absent), "depth" ("z", or "ray"), "width" and "height" of
/// the images (or "image_width" and "image_height"), and distortion by Brown and Conrady:
/// "distortion", "coeffs", "d", "D" or "distortion_coefficients", 4 to 8 numbers k1 k2 p1 p2 k3 k4
/// k5 k6, or these by name. "distortion_model" or "model" names the distortion model.
/// Throws JsonFault: another distortion model, a matrix with skew or in the wrong order, impossible
/// values.
Camera parse_camera(const JsonNode& node);

/// {"fx", "fy", "cx", "cy", "depth_scale"} and all other settings of the camera; parse_camera reads
/// it back unchanged.
nlohmann::ordered_json camera_json(const Camera& camera);

}  // namespace trivet

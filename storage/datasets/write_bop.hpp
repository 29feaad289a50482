/// Writing of the JSON files of a BOP data set. Meshes and images are written by write_ply and
/// write_depth_png to the paths of storage/datasets/bop.hpp.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "storage/common/result.hpp"
#include "storage/datasets/bop.hpp"

namespace trivet {

// Every file appears whole or not at all. Folders must exist, except the scene's own.
// Errors of all functions: cannot_create, io.

/// Writes models_info.json. The order of objects does not affect the file.
Result<void> write_bop_models_info(const std::filesystem::path& file,
                                   std::span<const BopObject> objects);

/// Writes camera.json for a sensor with this many pixels.
Result<void> write_bop_camera(const std::filesystem::path& file, const Camera& camera,
                              std::uint32_t width, std::uint32_t height);

/// Writes scene_camera.json, scene_gt.json and scene_gt_info.json to the folder of a scene, which
/// is created if necessary. The order of images does not affect the files.
Result<void> write_bop_scene(const std::filesystem::path& folder, std::span<const BopImage> images);

/// Writes test_targets_bop19.json (the number of instances of each object per image, counting those
/// with a visible fraction of at least kBopMinVisibleFraction) and test_targets_bop24.json (every
/// image) to the folder of the data set.
Result<void> write_bop_targets(const std::filesystem::path& folder,
                               std::span<const BopScene> scenes);

}  // namespace trivet

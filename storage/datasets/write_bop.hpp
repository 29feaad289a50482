/// Write the JSON files of a BOP data set; meshes and images are written by write_ply and
/// write_depth_png to the places that storage/datasets/bop.hpp names.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "storage/common/result.hpp"
#include "storage/datasets/bop.hpp"

namespace trivet {

// Every file appears whole or not at all. Folders must be there, except the scene's own.
// Errors of all: cannot_create, io.

/// models_info.json. Equal files for objects in any order.
Result<void> write_bop_models_info(const std::filesystem::path& file,
                                   std::span<const BopObject> objects);

/// camera.json of a sensor with this many pixels.
Result<void> write_bop_camera(const std::filesystem::path& file, const Camera& camera,
                              std::uint32_t width, std::uint32_t height);

/// scene_camera.json, scene_gt.json and scene_gt_info.json in the folder of a scene, which is made
/// if need be. Equal files for images in any order.
Result<void> write_bop_scene(const std::filesystem::path& folder, std::span<const BopImage> images);

/// test_targets_bop19.json: how many instances of which object each image shows, counting those of
/// which kBopMinVisibleFraction is visible; test_targets_bop24.json: every image. In the folder of
/// the data set.
Result<void> write_bop_targets(const std::filesystem::path& folder,
                               std::span<const BopScene> scenes);

}  // namespace trivet

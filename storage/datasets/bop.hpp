/// Layout of data sets of the BOP benchmark.
///
///     DATASET/models/obj_000001.ply, models_info.json       meshes [mm]
///     DATASET/models_eval/…                                 meshes for computing errors
///     DATASET/camera.json                                   the sensor, for rendering
///     DATASET/test/000001/depth/000003.png                  split, scene, image: 16-bit depth
///     DATASET/test/000001/mask/000003_000000.png            image, instance: 8 bits, 255 on it
///     DATASET/test/000001/mask_visib/000003_000000.png      the same for the visible part
///     DATASET/test/000001/scene_camera.json, scene_gt.json, scene_gt_info.json
///     DATASET/test/000001/scene_gt_coco.json                masks and boxes (storage/datasets/coco.hpp)
///     DATASET/test_targets_bop19.json, test_targets_bop24.json
///
/// Source: bop_toolkit, docs/bop_datasets_format.md. All lengths are millimeters.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "storage/data/cloud.hpp"
#include "storage/data/model.hpp"

namespace trivet {

/// Largest id of scenes, images and objects.
inline constexpr int kMaxBopId = 999'999'999;
/// Smallest visible fraction of BOP targets; instances below it count neither way.
inline constexpr double kBopMinVisibleFraction = 0.1;

/// Depth tolerance behind a measurement up to which a surface counts as visible [mm].
inline constexpr double kBopDeltaMm = 15;

/// An entry of models_info.json.
struct BopObject {
  int id = 0;
  double diameter_mm = 0;                             ///< largest distance between two vertices
  Eigen::Vector3d min_mm{0, 0, 0}, size_mm{0, 0, 0};  ///< bounding box
  Symmetry symmetry;                                  ///< lengths in mm; trivial: none
};

/// An object in an image: its entries in scene_gt.json and scene_gt_info.json.
struct BopInstance {
  int object_id = 0;
  Pose T_camera_model;  ///< camera with OpenCV axes; mm
  /// Bounding boxes x, y, width - 1, height - 1 [pixel] of the silhouette, also beyond the image,
  /// and of its visible part; all -1 if nothing is visible. The toolkit computes last column -
  /// first column.
  std::array<int, 4> bbox_obj{-1, -1, -1, -1}, bbox_visib{-1, -1, -1, -1};
  int px_count_all = 0;    ///< pixels of the silhouette without occlusion
  int px_count_valid = 0;  ///< silhouette pixels with a measured depth
  int px_count_visib = 0;  ///< silhouette pixels in which the object is visible
  double visib_fract = 0;  ///< px_count_visib / px_count_all; 0 without pixels
};

struct BopImage {
  int id = 0;
  Camera camera;  ///< depth_scale: millimeters per raw depth value
  std::vector<BopInstance> instances;
};

struct BopScene {
  int id = 0;
  std::vector<BopImage> images;
};

/// "obj_000001": the stem of an object's file and the name of its model.
std::string bop_model_name(int object_id);
/// SPLIT/000001
std::filesystem::path bop_scene_folder(const std::filesystem::path& split_folder, int scene_id);
/// SCENE/depth/000003.png
std::filesystem::path bop_depth_file(const std::filesystem::path& scene_folder, int image_id);
/// SCENE/mask/000003_000000.png, or in mask_visib. instance: index of the instance in the image.
std::filesystem::path bop_mask_file(const std::filesystem::path& scene_folder, int image_id,
                                    std::size_t instance);
std::filesystem::path bop_visible_mask_file(const std::filesystem::path& scene_folder, int image_id,
                                            std::size_t instance);

}  // namespace trivet

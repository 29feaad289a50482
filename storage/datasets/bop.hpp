/// Data sets in the form of the BOP benchmark: what they hold, and where.
///
///     DATASET/models/obj_000001.ply, models_info.json       meshes [mm]
///     DATASET/models_eval/…                                 meshes that errors are measured on
///     DATASET/camera.json                                   the sensor, for rendering
///     DATASET/test/000001/depth/000003.png                  split, scene, image: 16-bit depth
///     DATASET/test/000001/mask/000003_000000.png            image, instance: 8 bits, 255 on it
///     DATASET/test/000001/mask_visib/000003_000000.png      ... on what is visible of it
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

/// Of scenes, images and objects.
inline constexpr int kMaxBopId = 999'999'999;
/// Instances of which less is visible are no targets of BOP, and count neither way.
inline constexpr double kBopMinVisibleFraction = 0.1;

/// How far behind a measurement a surface still counts as visible [mm].
inline constexpr double kBopDeltaMm = 15;

/// An entry of models_info.json.
struct BopObject {
  int id = 0;
  double diameter_mm = 0;                             ///< largest distance between two vertices
  Eigen::Vector3d min_mm{0, 0, 0}, size_mm{0, 0, 0};  ///< bounding box
  Symmetry symmetry;                                  ///< lengths in mm; trivial: none
};

/// An object in an image: what scene_gt.json and scene_gt_info.json say of it.
struct BopInstance {
  int object_id = 0;
  Pose T_camera_model;  ///< camera with OpenCV axes; mm
  /// x, y, width - 1, height - 1 [pixel] of the silhouette, beyond the image too, and of its visible
  /// part; -1s where nothing is visible. The toolkit takes the last column less the first.
  std::array<int, 4> bbox_obj{-1, -1, -1, -1}, bbox_visib{-1, -1, -1, -1};
  int px_count_all = 0;    ///< pixels of the silhouette, as if nothing stood before it
  int px_count_valid = 0;  ///< ... that have a measured depth
  int px_count_visib = 0;  ///< ... in which the object is seen
  double visib_fract = 0;  ///< px_count_visib / px_count_all, 0 without any pixel
};

struct BopImage {
  int id = 0;
  Camera camera;  ///< depth_scale: raw depth times this is mm
  std::vector<BopInstance> instances;
};

struct BopScene {
  int id = 0;
  std::vector<BopImage> images;
};

/// "obj_000001": the stem of an object's file, and the name of its model.
std::string bop_model_name(int object_id);
/// SPLIT/000001
std::filesystem::path bop_scene_folder(const std::filesystem::path& split_folder, int scene_id);
/// SCENE/depth/000003.png
std::filesystem::path bop_depth_file(const std::filesystem::path& scene_folder, int image_id);
/// SCENE/mask/000003_000000.png, or in mask_visib. instance: its index in the image.
std::filesystem::path bop_mask_file(const std::filesystem::path& scene_folder, int image_id,
                                    std::size_t instance);
std::filesystem::path bop_visible_mask_file(const std::filesystem::path& scene_folder, int image_id,
                                            std::size_t instance);

}  // namespace trivet

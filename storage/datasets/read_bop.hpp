/// Read data sets in the form of the BOP benchmark (storage/datasets/bop.hpp) as manifests.
#pragma once

#include <filesystem>
#include <vector>

#include "storage/common/result.hpp"
#include "storage/datasets/bop.hpp"
#include "storage/datasets/manifest.hpp"

namespace trivet {

/// Whether this is the folder of a data set, which holds models_info.json in models/, models_cad/
/// or models_eval/, or the folder of one of its splits.
bool is_bop_folder(const std::filesystem::path& folder);

/// The models of a data set, without scenes; in mm, by object id.
///
/// folder   of the data set or of one of its splits
/// Meshes are those of the first folder of models/, models_cad/ and models_eval/ that is there, and
/// the errors are measured on those of models_eval/. An object that BOP gives no symmetry has none
/// declared. Whether the meshes themselves are there is not looked at.
/// Errors: missing_input, io, bad_data (names the JSON path of the fault).
Result<Manifest> read_bop_models(const std::filesystem::path& folder);

/// The models and the scenes of a data set, in mm, by scene and image id.
///
/// folder   of the data set, whose one split called test… is taken, or of any of its splits. Where
///          scenes have several cameras (scene_camera_CAM.json, depth_CAM/, scene_gt_CAM.json) that
///          one which has depth images is taken, or the one named as FOLDER:CAM
/// Depth images are PNG or TIFF files.
/// The images are those of the targets files, where a test split has one, else all. Targets carry
/// the numbers of instances that test_targets_bop19.json tells (or _bop24, if there is no other).
/// Without scene_gt.json there is no truth; by scene_gt_info.json, truth of which less than
/// kBopMinVisibleFraction is visible is to be ignored.
/// Errors: missing_input (also no test split, and an image whose depth is not there), io, bad_data
/// (names the JSON path of the fault; a camera that is no pinhole), usage (several test splits, or
/// several cameras with depth images).
Result<Manifest> read_bop(const std::filesystem::path& folder);

/// The entries of a models_info.json, by object id. Lengths that it lacks are 0.
/// Errors: missing_input, io, bad_data (names the JSON path of the fault).
Result<std::vector<BopObject>> read_bop_models_info(const std::filesystem::path& file);

}  // namespace trivet

/// Reading of BOP data sets (storage/datasets/bop.hpp) as manifests.
#pragma once

#include <filesystem>
#include <vector>

#include "storage/common/result.hpp"
#include "storage/datasets/bop.hpp"
#include "storage/datasets/manifest.hpp"

namespace trivet {

/// Whether this is the folder of a data set, with models_info.json in models/, models_cad/ or
/// models_eval/, or the folder of one of its splits.
bool is_bop_folder(const std::filesystem::path& folder);

/// The models of a data set, without scenes; in mm, by object id.
///
/// folder   folder of the data set or of one of its splits
/// The meshes are those of the first existing folder of models/, models_cad/ and models_eval/;
/// errors are measured on those of models_eval/. An object without a symmetry in BOP has none
/// declared. Whether the mesh files exist is not checked.
/// Errors: missing_input, io, bad_data (names the JSON path of the fault).
Result<Manifest> read_bop_models(const std::filesystem::path& folder);

/// The models and the scenes of a data set, in mm, by scene and image id.
///
/// folder   folder of the data set, whose only split called test… is chosen, or of any of its
///          splits. For scenes with several cameras (scene_camera_CAM.json, depth_CAM/,
///          scene_gt_CAM.json), the one with depth images is chosen, or the one named as FOLDER:CAM
/// Depth images are PNG or TIFF files.
/// The images are those of the targets files if a test split has one, otherwise all. Targets have
/// the instance counts of test_targets_bop19.json (or _bop24, if it is the only one). Without
/// scene_gt.json there is no ground truth. Ground truth with a visible fraction below
/// kBopMinVisibleFraction in scene_gt_info.json is to be ignored.
/// Errors: missing_input (also no test split, and an image without a depth file), io, bad_data
/// (names the JSON path of the fault; a camera that is not a pinhole), usage (several test splits,
/// or several cameras with depth images).
Result<Manifest> read_bop(const std::filesystem::path& folder);

/// The entries of a models_info.json, by object id. Missing lengths are 0.
/// Errors: missing_input, io, bad_data (names the JSON path of the fault).
Result<std::vector<BopObject>> read_bop_models_info(const std::filesystem::path& file);

}  // namespace trivet

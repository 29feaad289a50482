/// Result files of the BOP benchmark: one line per estimated pose.
///
///     scene_id,im_id,obj_id,score,R,t,time
///
/// R is nine numbers row by row and t three, separated by blanks. Source: bop_toolkit,
/// bop_toolkit_lib/inout.py.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <span>
#include <vector>

#include "storage/common/result.hpp"

namespace trivet {

struct BopResult {
  int scene_id = 0, image_id = 0, object_id = 0;
  double score = 0;
  /// Transform from the model to the camera: R x + t_mm, camera with OpenCV axes.
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t_mm{0, 0, 0};
  double seconds = -1;  ///< time for the whole image, equal in all of its results; -1: unknown
};

/// Whether a file is named METHOD_DATASET-SPLIT.EXT, METHOD_DATASET-SPLIT-TYPE.EXT, or either
/// followed by _ID. The toolkit derives the data set and its split from this name.
bool is_bop_result_name(const std::filesystem::path& file);

/// Write results in their order. Numbers read back unchanged. The file appears whole or not at all.
/// Pre: numbers are finite. Errors: cannot_create, io.
Result<void> write_bop_results(const std::filesystem::path& file,
                               std::span<const BopResult> results);

/// Read results in the order of the file.
/// Errors: missing_input, io, bad_data (names the line; also an R that is no rotation within 0.01,
/// and times of an image that differ by more than 1 ms).
Result<std::vector<BopResult>> read_bop_results(const std::filesystem::path& file);

}  // namespace trivet

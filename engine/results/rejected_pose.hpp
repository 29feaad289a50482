/// Poses that are not reported, and why.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "kernels/verification/pose_score.hpp"
#include "storage/data/model.hpp"

namespace trivet {

/// Why a pose was not reported.
enum class Rejection {
  too_low,    ///< the score, or pose_score if that is required, is below min_score
  explained,  ///< better poses already explain more than max_overlap of its pixels
  too_many,   ///< max_instances of its model are better
};

/// A pose that was tested in full but not reported.
struct RejectedPose {
  std::string model;
  float score = 0;              ///< as of a detection
  Pose T_scene_model;           ///< model point -> point of the cloud, in the scene file's unit
  kernels::ScoreParts parts{};  ///< what the score is made of
  Rejection reason = Rejection::too_low;
  /// Index of the detection that explains most of its pixels, and what share of them: with the
  /// reason `explained`, unless that one itself was one too many; and where one that is too low
  /// lies in the place of a better one.
  std::optional<std::size_t> explained_by{};
  float explained_share = 0;
};

}  // namespace trivet

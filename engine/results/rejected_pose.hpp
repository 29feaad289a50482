/// Tested poses that are not reported, and the reasons.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "kernels/scoring/pose_score.hpp"
#include "storage/data/model.hpp"

namespace trivet {

/// Reasons for not reporting a pose.
enum class Rejection {
  too_low,    ///< score, or pose_score if that is required, below min_score
  explained,  ///< better poses already explain more than max_overlap of its pixels
  too_many,   ///< max_instances of its model are better
};

/// A pose that was tested in full but not reported.
struct RejectedPose {
  std::string model;
  float score = 0;     ///< as for a detection
  Pose T_scene_model;  ///< maps model points to points of the cloud, in the scene file's unit
  kernels::ScoreParts parts{};  ///< components of the score
  Rejection reason = Rejection::too_low;
  /// Index of the detection that explains most of its pixels, and the share that it explains.
  /// Present with the reason `explained`, unless the explaining pose was itself refused for
  /// max_instances, and for a pose with too low a score at the place of a better one.
  std::optional<std::size_t> explained_by{};
  float explained_share = 0;
  /// How deep the model would be in a table, a floor or a wall that has no hole there, for which
  /// its score is 0 [diameters]; 0: not at all.
  float depth_in_ground = 0;
};

}  // namespace trivet

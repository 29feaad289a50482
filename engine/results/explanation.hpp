/// Why a model is found, or not found, at a place that the user asked about.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/results/rejected_pose.hpp"
#include "kernels/verification/examine_pose.hpp"

namespace trivet {

/// Stages of a pose. Each stage passes on the best poses.
enum class PoseStage : std::uint8_t {
  proposed,  ///< a cluster of votes or of matches, or an expected pose
  screened,  ///< scored by how many of some samples the scan shows
  refined,   ///< among the best of the screening
  examined,  ///< among the best refined ones: tested by rays, scored
};
/// Their names in results; "looked_at" is the screening.
inline constexpr std::array<std::string_view, 4> kPoseStages{"proposed", "looked_at", "refined",
                                                             "examined"};
/// Number of stages.
inline constexpr std::size_t kNumPoseStages = kPoseStages.size();

/// Names of the ray verdicts in results.
inline constexpr std::array<std::string_view, 6> kRayVerdicts{
    "agrees", "looked_through", "runs_on", "background", "hidden", "unmeasured"};

/// Outcome of the poses of one model that reach the place.
struct ModelExplanation {
  std::string model;
  /// Number of poses that reached each stage, over all rounds.
  std::array<std::size_t, kNumPoseStages> num_poses{};
  /// Index of the detection at the place, if there is one.
  std::optional<std::size_t> detection{};
  /// The best of the poses that reached the latest stage, with the score of its full test. Absent:
  /// none was proposed, or it moved elsewhere during refinement.
  std::optional<RejectedPose> pose{};
  /// Whether the search had discarded this pose before its full test. The test was then made for
  /// the explanation alone, and the reason does not apply.
  bool given_up = false;
  /// Rays of the full test of the detection's pose, or else of this one. Points are in the scene's
  /// frame and unit.
  std::vector<kernels::JudgedRay> rays{};

  /// The latest stage that any pose reached; absent: none was proposed.
  std::optional<PoseStage> reached() const noexcept {
    for (std::size_t k = kNumPoseStages; k > 0; --k) {
      if (num_poses[k - 1] > 0) return static_cast<PoseStage>(k - 1);
    }
    return std::nullopt;
  }
};

/// Explanation of a place.
struct PlaceExplanation {
  Eigen::Vector3d point{0, 0, 0};  ///< place in the frame and unit of the scene's file
  /// Distance to the nearest point of the scan, in the unit of the scene's file.
  double nearest_point = 0;
  std::vector<ModelExplanation> models;  ///< sorted by the latest stage reached, then by score
};

}  // namespace trivet

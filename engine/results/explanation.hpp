/// Why a model is found, or is not, at a place that recognition was asked about.
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

/// The steps that a pose passes, each of which lets the best go on.
enum class PoseStage : std::uint8_t {
  proposed,  ///< a cluster of votes or of matches, or an expected pose
  screened,  ///< scored by how many of some samples the scan shows
  refined,   ///< among the best of the screening
  examined,  ///< among the best refined ones: tested by rays, scored
};
/// Their names in results; "looked_at" is the screening.
inline constexpr std::array<std::string_view, 4> kPoseStages{"proposed", "looked_at", "refined",
                                                             "examined"};
/// How many there are.
inline constexpr std::size_t kNumPoseStages = kPoseStages.size();

/// The names of what a ray says, in results.
inline constexpr std::array<std::string_view, 6> kRayVerdicts{
    "agrees", "looked_through", "runs_on", "background", "hidden", "unmeasured"};

/// What became of the poses of one model that reach to the place.
struct ModelExplanation {
  std::string model;
  /// How many came to each stage, over all rounds.
  std::array<std::size_t, kNumPoseStages> num_poses{};
  /// Index of the detection that lies there, if one does.
  std::optional<std::size_t> detection{};
  /// The best of those that came furthest, with the score of its full test; none: nothing proposed
  /// one, or it moved elsewhere when it was refined.
  std::optional<RejectedPose> pose{};
  /// Whether the search had given this pose up before its full test, which was then made for the
  /// explanation alone: reason says nothing.
  bool given_up = false;
  /// What rays of the full test say of the detection's pose or this one. Places are in the scene's
  /// frame and unit.
  std::vector<kernels::JudgedRay> rays{};

  /// The last stage that a pose came to; none: nothing proposed one.
  std::optional<PoseStage> reached() const noexcept {
    for (std::size_t k = kNumPoseStages; k > 0; --k) {
      if (num_poses[k - 1] > 0) return static_cast<PoseStage>(k - 1);
    }
    return std::nullopt;
  }
};

/// What is known of a place.
struct PlaceExplanation {
  Eigen::Vector3d point{0, 0, 0};  ///< in the frame and unit of the scene's file
  /// Distance to the nearest point of the scan, in that unit.
  double nearest_point = 0;
  std::vector<ModelExplanation> models;  ///< what came furthest first, then by score
};

}  // namespace trivet

/// Complete plan of a search, made once from the options and the library.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "engine/hypotheses/cluster_proposals.hpp"
#include "engine/hypotheses/proposals.hpp"
#include "engine/hypotheses/propose_by_matches.hpp"
#include "engine/options/recognize_options.hpp"
#include "engine/scene/prepare_scene.hpp"
#include "engine/selection/decide_detections.hpp"
#include "engine/verification/verify_poses.hpp"
#include "storage/common/result.hpp"
#include "storage/library/library.hpp"

namespace trivet::engine {

inline constexpr std::size_t kNoLimit = std::numeric_limits<std::size_t>::max();

/// Voting in one round.
struct VotePlan {
  VoteOptions options{};
  /// Maximum number of models; those with the best poses so far are chosen.
  std::size_t max_models = kNoLimit;
  std::size_t max_pairs = kNoLimit;  ///< of a reference and a model, over all models
};

/// Matching in one round.
struct MatchPlan {
  MatchOptions options{};
  MatchLevels levels{};
  /// Factors on the distance between measurements and on their noise. Features finer than either
  /// product are left out too.
  float finest_spacing = 0, finest_noise = 0;
};

/// The sources that propose poses in one round.
struct RoundPlan {
  std::optional<VotePlan> votes{};
  std::optional<MatchPlan> matches{};
};

/// Limits of the poses verified in a round, over all models. They are counts, not times, so that
/// any number of threads gives the same result.
struct VerificationLimits {
  std::size_t screened = kNoLimit;  ///< proposed poses, those with the most votes
  std::size_t refined = kNoLimit;   ///< poses per pass, by the visible surface in screening
  /// Poses per pass tested by rays, by agreement of the refined pose.
  std::size_t examined = kNoLimit;
  std::uint32_t passes = 3;  ///< passes over the waiting poses that nothing explains yet
  /// Steps per pass from a pose to its look-alikes, then to theirs, and so on.
  std::uint32_t climbs = 2;
  std::size_t look_alikes = 8;   ///< look-alikes tested per pose
  std::size_t near_copies = 24;  ///< poses of near copies tested per chosen pose
  /// Minimum score by samples for testing a refined pose by rays. Of 600 tests with scores above
  /// 0.3 on the development scans, this limit lost none; it saves two thirds of all tests.
  float least_score = 0.05F;
};

struct SearchPlan {
  PrepareOptions prepare{};
  LargePlanes large_planes = LargePlanes::left_out;
  ModelGroups groups{};                 ///< models to search for, rising
  std::vector<std::uint32_t> models{};  ///< the same models in one list
  std::vector<ExpectedPose> expected{};
  std::vector<RoundPlan> rounds{};
  PoseOptions pose{};
  VerificationLimits limits{};
  VerificationOptions verification{};
  DecideOptions decide{};
  /// Maximum number of rejected poses per model to report, with reasons.
  std::uint32_t max_rejected = 0;
  PlaceQuestion question{};  ///< question with its point in the cloud's frame
};

/// Plan the search of one scene. The plan resolves presets, ablated improvements and the frame of
/// the scene's file.
///
/// options  valid options
/// offset   offset of the cloud (Cloud::offset)
/// Errors: usage (an unknown model, a method that the library was not trained for).
Result<SearchPlan> plan_search(const RecognizeOptions& options, const Library& library,
                               const Eigen::Vector3d& offset);

}  // namespace trivet::engine

/// What a search does, in full: made once of the options and the library.
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

/// Votes of one round.
struct VotePlan {
  VoteOptions options{};
  std::size_t max_models = kNoLimit;  ///< of more, those of the poses that look best so far
};

/// Matches of one round.
struct MatchPlan {
  MatchOptions options{};
  MatchLevels levels{};
  /// Features finer than these are left out, too: of the distance between measurements, and of
  /// their noise.
  float finest_spacing = 0, finest_noise = 0;
};

/// The sources that propose poses in one round.
struct RoundPlan {
  std::optional<VotePlan> votes{};
  std::optional<MatchPlan> matches{};
};

/// How many poses are verified in a round, over all models together: counts, never clocks, so that
/// any number of threads gives the same.
struct VerificationLimits {
  std::size_t screened = kNoLimit;  ///< of what is proposed, those of most votes
  std::size_t refined = kNoLimit;   ///< in each pass, by what their screening sees
  std::size_t examined = kNoLimit;  ///< ... by rays, by what the refined pose meets
  std::uint32_t passes = 3;         ///< over the poses that wait and that nothing explains yet
  std::uint32_t climbs = 2;         ///< from a pose to its look-alikes, to theirs, ..., in a pass
  std::size_t look_alikes = 8;      ///< of a pose, examined
  /// Score of a refined pose by samples below which no ray need be shot: of 600 examinations above
  /// 0.3 on the development scans this lost none, of all examinations it saves two thirds.
  float least_score = 0.05F;
};

struct SearchPlan {
  PrepareOptions prepare{};
  LargePlanes large_planes = LargePlanes::left_out;
  ModelGroups groups{};                 ///< models that are searched for, rising
  std::vector<std::uint32_t> models{};  ///< the same in one list
  std::vector<ExpectedPose> expected{};
  std::vector<RoundPlan> rounds{};
  PoseOptions pose{};
  VerificationLimits limits{};
  VerificationOptions verification{};
  DecideOptions decide{};
  std::uint32_t max_rejected = 0;  ///< poses per model that are told with the reason
  PlaceQuestion question{};        ///< its point is in the cloud's frame
};

/// Plan the search of one scene: here end presets, what is left out by name, and the frame of the
/// scene's file.
///
/// options  valid ones
/// offset   of the cloud (Cloud::offset)
/// Errors: usage (an unknown model, a method that the library was not trained for).
Result<SearchPlan> plan_search(const RecognizeOptions& options, const Library& library,
                               const Eigen::Vector3d& offset);

}  // namespace trivet::engine

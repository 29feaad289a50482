/// The search of one scene: rounds of proposals, and the choice among all that was verified.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "engine/loaded_library/recognizer.hpp"
#include "engine/recognition/recognize.hpp"
#include "engine/scene/prepare_scene.hpp"
#include "engine/verification/candidate.hpp"
#include "storage/common/result.hpp"

namespace trivet::engine {

/// Models of one sampling step: they share the sampled scene and its pair features.
using ModelGroups = std::map<float, std::vector<std::uint32_t>>;

/// A candidate that did not become a detection.
struct RefusedCandidate {
  Candidate candidate;
  Rejection reason = Rejection::too_low;
  /// Index of the detection that explains most of its pixels, and what share of them.
  std::optional<std::size_t> explained_by{};
  float explained_share = 0;
};

/// What became of a model's poses at the place that was asked about.
struct ExplainedModel {
  std::uint32_t model = 0;
  std::array<std::size_t, kNumPoseStages> num_poses{};
  std::optional<std::size_t> detection{};  ///< index of the one that lies there
  std::optional<RefusedCandidate>
      pose{};             ///< the best of those that came furthest, as it was tested
  bool given_up = false;  ///< before its full test, which was made for this alone
  std::vector<kernels::JudgedRay> rays{};  ///< of the detection's or this pose
};

/// Poses and lengths are in the scene's frame, in the library's unit.
struct SearchResult {
  std::vector<Candidate> detections;       ///< in the order of taking
  std::vector<RefusedCandidate> rejected;  ///< the best of each model, by falling score
  std::optional<std::vector<ExplainedModel>> explained{};  ///< if a place was asked about
};

/// Test the expected poses, then search round by round for what is not yet explained; of all
/// candidates take those that explain the scene together, and hold these against their
/// alternatives. What then lies where a better one does, or falls below the scores that are asked
/// for, is refused, and what it alone hid is held against its alternatives in its stead.
///
/// options  as ablate() gives them
/// stats    gets times and counts
/// Errors: internal (no memory for ray tracing). Throws Stopped.
Result<SearchResult> search_scene(const Recognizer& recognizer, const PreparedScene& scene,
                                  const ModelGroups& groups, const RecognizeOptions& options,
                                  SceneStats& stats);

}  // namespace trivet::engine

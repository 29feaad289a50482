/// Poses from correspondences of Tri-Spin-Images.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/hypotheses/match_features.hpp"
#include "engine/hypotheses/proposals.hpp"
#include "engine/loaded_library/recognizer.hpp"
#include "engine/results/recognize_result.hpp"
#include "engine/scene/prepare_scene.hpp"
#include "storage/common/result.hpp"

namespace trivet::engine {

/// Levels of the library's features to match a scene with.
struct MatchLevels {
  /// Whether to use only the finest level of each model; coarser ones serve large libraries.
  bool only_own = true;
  float finest = 0;  ///< resolution limit; finer features are left out [library unit]
};

/// Source of poses by matching. The scene is matched once, when matches are first needed.
class MatchSource {
 public:
  /// Keeps references to all arguments but `levels`.
  ///
  /// models  models to search for, rising
  /// stats   receives times
  MatchSource(const Recognizer& recognizer, const PreparedScene& scene,
              std::span<const std::uint32_t> models, LargePlanes large_planes, SceneStats& stats)
      : recognizer_(recognizer),
        scene_(scene),
        models_(models),
        large_planes_(large_planes),
        stats_(stats) {}

  /// explained  nonzero for pixels whose keypoints do not count, images concatenated; empty: none
  /// Errors: damaged.
  Result<std::vector<Proposals>> propose(const MatchOptions& options, const MatchLevels& levels,
                                         std::span<const std::uint8_t> explained);

 private:
  Result<void> match(const MatchOptions& options, const MatchLevels& levels,
                     std::span<const std::uint8_t> explained);

  const Recognizer& recognizer_;
  const PreparedScene& scene_;
  const std::span<const std::uint32_t> models_;
  const LargePlanes large_planes_;
  SceneStats& stats_;
  bool is_matched_ = false;
  std::vector<SceneMatches> matches_;  // one per level of features
};

}  // namespace trivet::engine

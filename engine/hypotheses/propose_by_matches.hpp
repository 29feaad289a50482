/// Poses that matches of Tri-Spin-Images give.
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

/// Which levels of the library's features a scene is matched with.
struct MatchLevels {
  bool only_own = true;  ///< of each model only its finest: coarser ones serve large libraries
  float finest = 0;      ///< features of a finer resolution are left out [library unit]
};

/// The scene is matched once, when matches are first asked for.
class MatchSource {
 public:
  /// All arguments but `levels` are referred to.
  ///
  /// models  rising, that are searched for
  /// stats   gets times
  MatchSource(const Recognizer& recognizer, const PreparedScene& scene,
              std::span<const std::uint32_t> models, LargePlanes large_planes, SceneStats& stats)
      : recognizer_(recognizer),
        scene_(scene),
        models_(models),
        large_planes_(large_planes),
        stats_(stats) {}

  /// explained  nonzero for pixels whose keypoints do not count, of all images one after the other;
  ///            empty: none
  /// Errors: bad_data (damaged).
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
  std::vector<SceneMatches> matches_;  // one a level of features
};

}  // namespace trivet::engine

/// Poses from correspondences of Tri-Spin-Images in a sampled scene.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/options/recognize_options.hpp"
#include "engine/scene/prepare_scene.hpp"
#include "engine/scene/sample_scene.hpp"
#include "kernels/common/hypothesis.hpp"
#include "kernels/spin_images/tri_spin_image.hpp"
#include "storage/data/feature_index.hpp"
#include "storage/data/tri_spin_features.hpp"

namespace trivet::engine {

struct FeatureMatch {
  std::uint32_t keypoint = 0;   ///< index in the scene
  std::uint32_t model = 0;      ///< index in the library
  Eigen::Vector3f model_point;  ///< model point that corresponds to the keypoint
  Pose T_scene_model;           ///< pose by the two local reference frames
  float votes = 1;
};

/// Correspondences of a scene's features.
struct SceneMatches {
  float spacing = 0;  ///< distance between keypoints
  Points keypoints;
  std::vector<FeatureMatch> matches;  ///< sorted by keypoint, the nearest first
};

/// A scene sampled at the resolution of the features that it is matched with. All is referred to.
struct SampledScene {
  const PreparedScene& scene;
  const SceneSample& sample;
  /// Nonzero for pixels whose keypoints stay out, of all images one after the other; empty: none.
  std::span<const std::uint8_t> explained{};
};

/// Describe a sampled scene, and match each feature with the nearest ones of the models.
///
/// after_part  as of search_codes
/// A match gives a pose by its two frames: R = E_scene^T E_model, t = p_scene - R p_model (Guo et
/// al., IJCV 2013, section 5.2). Same bytes for any number of threads.
SceneMatches match_features(const TriSpinBasis& basis, const FeatureLevel& level,
                            const SampledScene& sampled, const MatchOptions& options,
                            const std::function<void()>& after_part = {});

/// The poses of correspondences, per model of the library. Correspondences whose keypoint lies on a
/// pixel marked after matching are excluded.
std::vector<std::vector<kernels::Hypothesis>> hypotheses_of(const SceneMatches& matches,
                                                            const PreparedScene& scene,
                                                            std::span<const std::uint8_t> explained,
                                                            std::size_t num_models,
                                                            Grouping grouping);

}  // namespace trivet::engine

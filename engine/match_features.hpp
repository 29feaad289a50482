/// From a sampled scene to poses that matches of Tri-Spin-Images give.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/feature_library.hpp"
#include "engine/prepare_scene.hpp"
#include "kernels/cluster_poses.hpp"
#include "kernels/tri_spin_image.hpp"
#include "storage/tri_spin_features.hpp"

namespace trivet::engine {

struct MatchOptions {
  float spacing = 3;                    ///< of a scene's keypoints [resolutions]
  std::uint32_t max_keypoints = 10000;  ///< of more, so many spread over all are described
  kernels::FrameLimits limits{};
  std::size_t num_neighbours = 3;  ///< features of models that a scene's feature is matched with
  std::size_t max_checks = 256;    ///< features that it is compared with
};

struct FeatureMatch {
  std::uint32_t keypoint = 0;  ///< of the scene
  std::uint32_t model = 0;     ///< of the library
  Pose T_scene_model;
};

/// What the features of a scene were matched with.
struct SceneMatches {
  float spacing = 0;  ///< between keypoints
  Points keypoints;
  std::vector<FeatureMatch> matches;  ///< in the order of the keypoints, the nearest first
};

/// Describe a scene that was sampled at the level's resolution, and match each feature with the
/// nearest ones of the models. Keypoints on a marked pixel stay out.
///
/// explained  nonzero for marked pixels, of all images one after the other; empty: none
/// A match gives a pose by its two frames: R = E_scene^T E_model, t = p_scene - R p_model (Guo et
/// al., IJCV 2013, section 5.2). Same bytes for any number of threads.
SceneMatches match_features(const TriSpinBasis& basis, const FeatureLevel& level,
                            const PreparedScene& scene, const SceneSample& sample,
                            std::span<const std::uint8_t> explained,
                            const MatchOptions& options = {});

/// The poses of matches, per model of the library, each with one vote. Matches whose keypoint lies
/// on a pixel that was marked since stay out.
std::vector<std::vector<kernels::Hypothesis>> hypotheses_of(const SceneMatches& matches,
                                                            const PreparedScene& scene,
                                                            std::span<const std::uint8_t> explained,
                                                            std::size_t num_models);

}  // namespace trivet::engine

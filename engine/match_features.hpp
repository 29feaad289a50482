/// From a sampled scene to poses that matches of Tri-Spin-Images give.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/feature_library.hpp"
#include "engine/prepare_scene.hpp"
#include "kernels/cluster_poses.hpp"

namespace trivet::engine {

struct MatchOptions {
  std::size_t num_neighbours = 3;  ///< features of models that a scene's feature is matched with
  std::size_t max_checks = 256;    ///< features that it is compared with
};

/// Describe a scene that was sampled at the level's resolution, and match each feature with the
/// nearest ones of the models: hypotheses per model of the library, in the order of the keypoints.
///
/// A match gives a pose by its two frames: R = E_scene^T E_model, t = p_scene - R p_model (Guo et
/// al., IJCV 2013, section 5.2). Same bytes for any number of threads.
std::vector<std::vector<kernels::Hypothesis>> match_features(const FeatureLibrary& library,
                                                             const FeatureLevel& level,
                                                             const SceneSample& sample,
                                                             std::size_t num_models,
                                                             const MatchOptions& options);

}  // namespace trivet::engine

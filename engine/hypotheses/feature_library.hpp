/// The Tri-Spin-Images of a library's models, ready to be matched.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/spin_images/feature_forest.hpp"
#include "storage/library.hpp"

namespace trivet::engine {

/// Features of the models of one resolution. Feature i is vector i of the forest.
struct FeatureLevel {
  float resolution = 0;               ///< [library unit]
  std::vector<std::uint32_t> models;  ///< that have features, rising
  std::vector<std::uint32_t> model;   ///< of each feature
  Points keypoints;                   ///< in the model's frame
  std::vector<Eigen::Matrix3f> frames;
  kernels::FeatureForest forest;
};

/// Index the features of a library, in levels by rising resolution. Deterministic.
std::vector<FeatureLevel> index_features(const Library& library);

}  // namespace trivet::engine

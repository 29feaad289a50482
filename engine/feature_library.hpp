/// The Tri-Spin-Images of a library's models, ready to be matched.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/describe_model.hpp"
#include "kernels/feature_forest.hpp"
#include "kernels/pca.hpp"
#include "storage/result.hpp"

namespace trivet {
class Recogniser;
}

namespace trivet::engine {

/// Features of the models of one resolution. Feature i is vector i of the forest.
struct FeatureLevel {
  float resolution = 0;              ///< [library unit]
  std::vector<std::uint32_t> model;  ///< of each feature
  Points keypoints;                  ///< in the model's frame
  std::vector<Eigen::Matrix3f> frames;
  kernels::FeatureForest forest;
};

struct FeatureLibrary {
  DescribeOptions options;
  kernels::PcaBasis basis;           ///< of all levels: images know no size
  std::vector<FeatureLevel> levels;  ///< by rising resolution
};

/// Describe all models of a library, find the principal components of their images, and index what
/// is left in these. Deterministic.
/// Errors: internal (no memory for a model's ray-tracing tree).
Result<FeatureLibrary> build_features(const Recogniser& recogniser, const DescribeOptions& options);

}  // namespace trivet::engine

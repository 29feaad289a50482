/// The Tri-Spin-Images of a library's models, ready to be matched.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "kernels/spin_images/code_index.hpp"
#include "storage/library.hpp"

namespace trivet::engine {

/// Features of the models of one resolution, in the order of the index.
struct FeatureLevel {
  float resolution = 0;                 ///< [library unit]
  std::vector<std::uint32_t> models;    ///< that have features, rising
  std::vector<std::uint32_t> model;     ///< of each feature
  Points keypoints;                     ///< in the model's frame
  std::vector<Eigen::Matrix3f> frames;  ///< rows e1, e2, e3
  Column<std::uint8_t> centroids, codes;
  std::vector<std::uint32_t> offsets;

  kernels::CodeIndexView index() const noexcept;
};

/// Index the features of a library, in levels by rising resolution. Same bytes for any number of
/// threads.
std::vector<FeatureLevel> index_features(const Library& library);

}  // namespace trivet::engine

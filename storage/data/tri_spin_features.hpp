/// What a library keeps of its models' Tri-Spin-Images.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "storage/common/columns.hpp"
#include "storage/common/shared.hpp"
#include "storage/data/pca_basis.hpp"
#include "storage/data/points.hpp"

namespace trivet {

/// Rows e1, e2, e3 of a local reference frame, one after the other.
using FrameRows = std::array<float, 9>;

/// The features of one model: Tri-Spin-Images in the library's principal components.
struct TriSpinFeatures {
  float resolution = 0;          ///< that scenes are sampled at to be compared [library unit]
  Shared<PointsView> keypoints;  ///< n, in the model's frame
  Shared<std::span<const FrameRows>> frames;    ///< n
  Shared<std::span<const std::uint8_t>> codes;  ///< n of num_components each, see TriSpinBasis
  std::size_t num_components = 0;

  std::size_t size() const noexcept { return keypoints.size(); }
};

/// Models are described at their own resolution and so many half octaves above it: at two and four
/// times its distance, for scans that are too coarse for what is small.
inline constexpr std::array<std::uint32_t, 3> kFeatureScales{0, 2, 4};

/// ... of a model that is named by its rank in a library.
struct FeaturesOfModel {
  std::uint32_t model = 0;
  TriSpinFeatures features;
};

/// What the features of all models of a library have in common.
struct TriSpinBasis {
  float support = 0;    ///< radius of what an image shows [resolutions]
  PcaBasis components;  ///< of the images; none: no model has features
  float code_step = 0;  ///< a code c stands for the number (c - 128) code_step
};

}  // namespace trivet

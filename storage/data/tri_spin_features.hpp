/// Tri-Spin-Image features as stored in a library.
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

/// Rows e1, e2, e3 of a local reference frame, concatenated.
using FrameRows = std::array<float, 9>;

/// The features of one model: Tri-Spin-Images as coefficients of the library's principal
/// components.
struct TriSpinFeatures {
  float resolution = 0;          ///< sampling distance of scenes for comparison [library unit]
  Shared<PointsView> keypoints;  ///< n keypoints in the model's frame
  Shared<std::span<const FrameRows>> frames;    ///< n local reference frames
  Shared<std::span<const std::uint8_t>> codes;  ///< n codes of num_components bytes each, see
                                                ///< TriSpinBasis
  std::size_t num_components = 0;

  std::size_t size() const noexcept { return keypoints.size(); }
};

/// Scales of the description in half octaves above the model's own resolution: at its sampling
/// distance, and at two and four times it, for scans too coarse to show small details.
inline constexpr std::array<std::uint32_t, 3> kFeatureScales{0, 2, 4};

/// Features of a model that is identified by its rank in a library.
struct FeaturesOfModel {
  std::uint32_t model = 0;
  TriSpinFeatures features;
};

/// Data common to the features of all models of a library.
struct TriSpinBasis {
  float support = 0;    ///< support radius of an image [resolutions]
  PcaBasis components;  ///< principal components of the images; none: no model has features
  float code_step = 0;  ///< step of a code: code c stands for the number (c - 128) code_step
};

}  // namespace trivet

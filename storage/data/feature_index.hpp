/// Tri-Spin-Image features of all models of a library, in the order of the search.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "storage/common/shared.hpp"
#include "storage/data/points.hpp"

namespace trivet {

/// A rotation as a unit quaternion (w, x, y, z) with w >= 0. Each component q is stored as round((q
/// + 1) 32767).
using RotationCode = std::array<std::uint16_t, 4>;

/// The features of all models at one resolution as an inverted file: each feature is in the list of
/// the centroid nearest to its code. All data that a match needs is stored beside the codes, so
/// matching reads no model.
struct FeatureLevel {
  float resolution = 0;    ///< distance between the described points [library unit]
  std::size_t stride = 0;  ///< bytes of a code, padded with zeros
  Shared<std::span<const std::uint32_t>> models;  ///< indices of the models with features,
                                                  ///< ascending
  Shared<std::span<const std::uint8_t>> centroids;
  Shared<std::span<const std::uint32_t>> offsets;  ///< start of each list, then the end
  Shared<std::span<const std::uint8_t>> codes;     ///< codes, list by list
  Shared<std::span<const std::uint32_t>> model;    ///< model index of each feature
  Shared<PointsView> keypoints;                    ///< keypoints in the model's frame
  Shared<std::span<const RotationCode>> frames;    ///< codes of the rotation matrices with rows e1,
                                                   ///< e2, e3

  std::size_t size() const noexcept { return model.size(); }
};

/// Levels in ascending order of resolution.
using FeatureIndex = std::vector<FeatureLevel>;

/// Consecutive features of a level, to be written.
struct ListedFeaturesSpan {
  std::span<std::uint8_t> codes;
  std::span<std::uint32_t> model;
  PointsSpan keypoints;
  std::span<RotationCode> frames;

  std::size_t size() const noexcept { return model.size(); }
};

/// A level whose features are produced in pieces, so that they need not all be in memory.
struct LevelInPieces {
  FeatureLevel level;  ///< level without its features
  /// Writes the features from `first` on. Pieces may have any size and come in any order.
  std::function<void(std::size_t first, const ListedFeaturesSpan& features)> list;

  std::size_t size() const noexcept { return level.offsets.back(); }
};

}  // namespace trivet

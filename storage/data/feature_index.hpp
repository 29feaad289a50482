/// The Tri-Spin-Images of all models of a library, in the order in which they are looked for.
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

/// A rotation as a unit quaternion (w, x, y, z) with w >= 0: each number q as round((q + 1) 32767).
using RotationCode = std::array<std::uint16_t, 4>;

/// The features of all models of one resolution as an inverted file: each stands in the list of the
/// centroid that its code is nearest to. What a match needs lies beside the codes, so that no model
/// is looked into for it.
struct FeatureLevel {
  float resolution = 0;    ///< distance between the points that were described [library unit]
  std::size_t stride = 0;  ///< bytes of a code, filled up with zeros
  Shared<std::span<const std::uint32_t>> models;  ///< that have features, rising
  Shared<std::span<const std::uint8_t>> centroids;
  Shared<std::span<const std::uint32_t>> offsets;  ///< where each list begins, and the end
  Shared<std::span<const std::uint8_t>> codes;     ///< list by list
  Shared<std::span<const std::uint32_t>> model;    ///< of each feature
  Shared<PointsView> keypoints;                    ///< in the model's frame
  Shared<std::span<const RotationCode>> frames;    ///< of the matrices whose rows are e1, e2, e3

  std::size_t size() const noexcept { return model.size(); }
};

/// Levels by rising resolution.
using FeatureIndex = std::vector<FeatureLevel>;

/// Some features of a level, one after the other, to be written.
struct ListedFeaturesSpan {
  std::span<std::uint8_t> codes;
  std::span<std::uint32_t> model;
  PointsSpan keypoints;
  std::span<RotationCode> frames;

  std::size_t size() const noexcept { return model.size(); }
};

/// A level whose features are made piece by piece, so that they need not be in memory together.
struct LevelInPieces {
  FeatureLevel level;  ///< without its features
  /// Write the features from `first` on. Pieces may have any size and come in any order.
  std::function<void(std::size_t first, const ListedFeaturesSpan& features)> list;

  std::size_t size() const noexcept { return level.offsets.back(); }
};

}  // namespace trivet

/// Selection of the points of a cloud to drop, by thinning or by an occluder.
///
/// Marks are 1 for points that stay; functions only clear them, so they can be combined.
/// keep_points (storage/formats/keep_points.hpp) then removes the points.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>

#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Keep each point with probability `share`, by the seed and its index alone. The points kept for a
/// smaller share are a subset of those for a larger one with the same seed.
///
/// first   index of keep[0] in the whole cloud: any split into chunks gives the same bits
/// No allocation or lock.
void keep_at_random(double share, std::uint64_t seed, std::size_t first,
                    std::span<std::uint8_t> keep) noexcept;

/// The half-space of the points p with direction . p > offset.
struct HalfSpace {
  Eigen::Vector3f direction{0, 0, 1};
  float offset = 0;
};

/// Drop the points in a half-space.
///
/// points   n positions; non-finite ones stay
/// keep     n marks
/// No allocation or lock. Rows are independent: any split into chunks gives the same bits.
void drop_half_space(PointsView points, const HalfSpace& gone, std::span<std::uint8_t> keep);

/// The half-space with the given share of the points, those that lie farthest along a direction.
///
/// points    n finite positions
/// share     0..1; the half-space holds floor(share n) points, fewer only if several points tie at
///           its border
/// scratch   n numbers
/// Cost: O(n). No allocation or lock.
HalfSpace cut_share(PointsView points, const Eigen::Vector3f& direction, double share,
                    std::span<float> scratch);

}  // namespace trivet::kernels

/// Poses from point correspondences, without local reference frames.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/common/hypothesis.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Correspondences between points of a scene and of a model.
struct PointMatches {
  PointsView scene, model;  ///< n points each
};

/// The least-squares rigid transform from the model's points to the scene's.
///
/// chosen  indices of at least three correspondences, not all collinear
/// Source: Umeyama, PAMI 1991, without scale.
Pose fit_pose(const PointMatches& matches, std::span<const std::uint32_t> chosen);

/// Group correspondences, in their order, so that any two of a group agree on the distance between
/// their points. Returns the poses of groups, largest first, with their sizes as votes. No
/// correspondence is in two groups.
///
/// tolerance  tolerance of the distances [scene unit], > 0
/// min_size   smaller groups are dropped, >= 3
/// Cost: n^2 at worst. Allocates.
/// Source: Chen and Bhanu, "3D free-form object recognition in range images using local surface
/// patches", Pattern Recognition Letters 2007.
std::vector<Hypothesis> group_by_consistency(const PointMatches& matches, float tolerance,
                                             std::size_t min_size);

/// Draw triples of correspondences with consistent distances. Returns the pose of each triple with
/// at least `min_size` inliers within the tolerance, fitted to the inliers, with their number as
/// votes, in the order of the draws.
///
/// num_draws  attempts, most of which end with inconsistent distances
/// Cost: n per consistent triple. Allocates.
/// Source: Fischler and Bolles, CACM 1981.
std::vector<Hypothesis> group_by_ransac(const PointMatches& matches, float tolerance,
                                        std::size_t min_size, std::uint32_t num_draws,
                                        std::uint64_t seed);

}  // namespace trivet::kernels

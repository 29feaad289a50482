/// From matched points to poses, without frames.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/common/hypothesis.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Points of a scene and of a model that may be one.
struct PointMatches {
  PointsView scene, model;  ///< n each
};

/// The rigid motion that takes the model's points nearest to the scene's.
///
/// chosen  indices of at least three matches, not all on a line
/// Source: Umeyama, PAMI 1991, without scale.
Pose fit_pose(const PointMatches& matches, std::span<const std::uint32_t> chosen);

/// Gather matches, the first ones first, into groups in which any two agree on the distance of
/// their points; the poses of groups, largest first, with their sizes for votes. No match is in two
/// groups.
///
/// tolerance  of the distances [scene unit], > 0
/// min_size   groups below are left out, >= 3
/// Cost: n^2 at worst. Takes memory.
/// Source: Chen and Bhanu, "3D free-form object recognition in range images using local surface
/// patches", Pattern Recognition Letters 2007.
std::vector<Hypothesis> group_by_consistency(const PointMatches& matches, float tolerance,
                                             std::size_t min_size);

/// Draw triples of matches whose distances agree; the pose of each that takes at least `min_size`
/// matches to within the tolerance, fitted to these, with their number for votes. In the order of
/// the draws.
///
/// num_draws  attempts, most of which end with distances that disagree
/// Cost: n a triple that agrees. Takes memory.
/// Source: Fischler and Bolles, CACM 1981.
std::vector<Hypothesis> group_by_ransac(const PointMatches& matches, float tolerance,
                                        std::size_t min_size, std::uint32_t num_draws,
                                        std::uint64_t seed);

}  // namespace trivet::kernels

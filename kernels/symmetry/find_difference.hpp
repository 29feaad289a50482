/// Where two similar surfaces differ.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "kernels/surfaces/model_samples.hpp"
#include "storage/data/model.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// The region around the largest distance of two surfaces, in the frame and unit of the first one.
struct SurfaceDifference {
  float deviation = 0;              ///< largest distance
  Eigen::Vector3f center{0, 0, 0};  ///< mean of the region's samples
  float size = 0;                   ///< twice the largest distance of a sample from the center
  /// Unit vector towards where most of the region is seen from; zero if it is not seen at all.
  Eigen::Vector3f look_from{0, 0, 0};
};

/// Compute the distances of oriented points from a sampled surface. Samples that face the same way,
/// within 60 degrees, stand for discs of 1.5 spacings, which leave no holes between them; all others
/// for points, or discs of a wall would reach beyond its edge.
///
/// surface          n >= 1 samples with unit normals
/// points, normals  m positions and unit vectors in the surface's frame
/// out              m distances in its unit
/// Pre: out.size() == points.size(). No allocation. Each row is independent. Cost: n m.
void surface_distances(const ModelSamples& surface, PointsView points, NormalsView normals,
                       std::span<float> out) noexcept;

/// Find where two surfaces differ most: the connected samples of both, linked over up to three
/// spacings, that are at least half as far from the other surface as the farthest one. It is seen
/// best from the view that sees most of them, weighted by their distance and by how they face it.
///
/// first, second  samples with unit normals and view masks, at least one each
/// Deterministic: ties go to the first sample and the lowest view. Cost: the product of both
/// numbers of samples.
SurfaceDifference find_difference(const ModelSamples& first, const ModelSamples& second,
                                  const Pose& T_first_second);

}  // namespace trivet::kernels

/// Local reference frame of a keypoint.
#pragma once

#include <Eigen/Core>
#include <span>

#include "kernels/spin_images/support.hpp"
#include "storage/data/cloud.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Axes of a local reference frame, and how reliably the surface determines them.
struct LocalFrame {
  Eigen::Matrix3f axes = Eigen::Matrix3f::Zero();  ///< rows e1, e2, e3; a rotation, or 0 for none
  float first_ratio = 1;   ///< ratio of the largest eigenvalue to the second, >= 1
  float second_ratio = 1;  ///< ratio of the second eigenvalue to the smallest, >= 1
  float lean = 0;          ///< offset of the surface's mean to one side [radii]: 0.25 at a border
  float hold = 0;          ///< reliability of e1 from heights (aim_first_axis), 0 to 1
};

/// The frame of the weighted points of a support: eigenvectors of their scatter about the keypoint,
/// by descending eigenvalue. e1 points to where there is more surface, e3 to the side of the
/// normal, e2 = e3 x e1.
///
/// radius  > 0, radius of the support
/// normal  the keypoint's normal, outward or towards the sensor; if it is NaN, e3 points to where
///         there is more surface
/// Weights are the areas times (radius - distance)^2. The axes are 0 for fewer than 5 points, or if
/// all have no area or coincide.
/// No allocation, lock or throw. Same bits on any processor.
/// Source: Guo et al., "Trisi: a distinctive local surface descriptor for 3D modeling and object
/// recognition", GRAPP 2013, with points for triangles.
LocalFrame local_frame(const Support& support, float radius,
                       const Eigen::Vector3f& normal) noexcept;

/// Triangles around a keypoint.
struct TriangleSupport {
  PointsView vertices;
  const Triangles& triangles;             ///< corners < vertices.size()
  std::span<const std::uint32_t> around;  ///< triangles around the keypoint: all of them, perhaps
                                          ///< more
  float max_edge;                         ///< a triangle with a longer edge has no weight
};

/// As above, for triangles, each with the exact second moments of its area; those with a centroid
/// beyond the radius have no weight.
///
/// Source: Guo et al., "Rotational projection statistics", IJCV 2013, eq. 1 to 8; the limit on
/// edges is TriSI's.
LocalFrame local_frame(const TriangleSupport& support, const Eigen::Vector3f& keypoint,
                       float radius, const Eigen::Vector3f& normal) noexcept;

/// Rotate a frame about e3, so that e1 points to where the surface rises or falls most.
///
/// frame  frame of this support; sets its hold. If nothing has a height, or there is no frame, the
///        axes stay and the hold is 0
/// e1 is the mean of the points' directions perpendicular to e3, weighted by their areas, (radius -
/// distance)^2 and the square of their height along e3. Most surfaces are so round or flat that two
/// eigenvalues of their scatter are nearly equal, so that the e1 of the scatter depends on noise
/// and sampling; heights depend on the shape alone.
/// No allocation, lock or throw. Same bits on any processor.
/// Source: Yang, Zhang, Xian, Cao, "TOLDI: an effective and robust approach for 3D local shape
/// description", Pattern Recognition 2017, with areas.
void aim_first_axis(const Support& support, float radius, LocalFrame& frame) noexcept;

}  // namespace trivet::kernels

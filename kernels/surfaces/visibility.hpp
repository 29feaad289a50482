/// Directions from which surface points are visible, and outward orientation of normals.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>

#include "kernels/common/ray_scene.hpp"
#include "storage/data/model.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

inline constexpr std::size_t kNumViews = 64 * kViewWords;

/// A surface seen at more than 80 degrees from its normal gives no usable measurement.
inline constexpr float kMinViewCosine = 0.17365F;

/// Surface model for clouds, which have no faces: spheres of kCloudRadius times the spacing around
/// the points, with rays that start kCloudOffset times the spacing above their point.
///
/// Spacing s is the step of the grid or disc subsampling that made the cloud. On a square grid the
/// farthest position from all points is s / sqrt(2) = 0.71 s away: radius 0.8 s leaves no holes.
/// The spheres of a flat neighborhood reach 0.8 s above it: from 1.0 s, any ascending ray is free.
/// A wall of a thickness between 0.2 s and 1.8 s is one solid; below, both of its sides appear
/// free.
inline constexpr float kCloudRadius = 0.8F;
inline constexpr float kCloudOffset = 1.0F;

/// Unit vector from the object to the camera for view d < kNumViews: a point of the Fibonacci
/// sphere, z = 1 - (2 d + 1) / kNumViews, longitude d times the golden angle pi (3 - sqrt 5).
/// Neighbors are about 14 degrees apart. Library files rely on this numbering.
Eigen::Vector3f view_direction(std::size_t d) noexcept;

/// The view nearest to a direction (any length > 0); the lowest index among equals.
std::size_t nearest_view(const Eigen::Vector3f& direction) noexcept;

/// Whether bit d of a mask is set.
inline bool is_visible(const ViewMask& mask, std::size_t d) noexcept {
  return (mask[d / 64] >> (d % 64) & 1U) != 0;
}

inline constexpr ViewMask kAllViews{~std::uint64_t{0}, ~std::uint64_t{0}, ~std::uint64_t{0},
                                    ~std::uint64_t{0}};

/// Find the directions from which each point is visible.
///
/// scene    the surface; the points lie on it [m]
/// points   n positions [m]
/// normals  n outward unit vectors
/// offset   > 0 [m]: rays start this far along the normal, to miss the surface they start on
/// wanted   directions to test; the bits of all others stay 0
/// masks    n; bit d is set if normal . view_direction(d) > kMinViewCosine and the ray from the
///          point towards the camera hits nothing. NaN normals give an empty mask.
/// Rows are independent: any split into chunks gives the same bits. No allocation.
void compute_views(const RayScene& scene, PointsView points, NormalsView normals, float offset,
                   const ViewMask& wanted, std::span<ViewMask> masks);

/// Orient each normal to the outside, the side with more free views, and compute its views.
///
/// As `compute_views`, but normals are correct up to their sign, as from an unreliable winding or a
/// plane fit. A normal is flipped if the other side has more than twice the free views of this one.
/// Otherwise it is kept: both sides of an open sheet are outside. An empty mask means that neither
/// side is visible: the point is inside the object and should be dropped.
void orient_outward(const RayScene& scene, PointsView points, NormalsSpan normals, float offset,
                    std::span<ViewMask> masks);

}  // namespace trivet::kernels

/// From which directions a point of a surface can be seen, and which side of it is outside.
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

/// For clouds, which have no faces: spheres of kCloudRadius times the spacing around the points
/// stand for the surface, and rays start kCloudOffset times the spacing above their point.
///
/// Spacing s is the step of the grid or disc subsampling that made the cloud. On a square grid the
/// farthest place from all points is s / sqrt(2) = 0.71 s away: radius 0.8 s leaves no holes. The
/// spheres of a flat neighborhood reach 0.8 s above it: from 1.0 s a ray that rises at all is
/// free. A wall of a thickness between 0.2 s and 1.8 s is one solid; below, both of its sides look
/// free.
inline constexpr float kCloudRadius = 0.8F;
inline constexpr float kCloudOffset = 1.0F;

/// Unit vector from the object to the camera for view d < kNumViews: a point of the Fibonacci
/// sphere, z = 1 - (2 d + 1) / kNumViews, longitude d times the golden angle pi (3 - sqrt 5). About
/// 14 degrees lie between neighbors. Library files rely on this numbering.
Eigen::Vector3f view_direction(std::size_t d) noexcept;

/// The view nearest to a direction (any length > 0); the lowest index among equals.
std::size_t nearest_view(const Eigen::Vector3f& direction) noexcept;

/// Whether bit d of a mask is set.
inline bool is_visible(const ViewMask& mask, std::size_t d) noexcept {
  return (mask[d / 64] >> (d % 64) & 1U) != 0;
}

inline constexpr ViewMask kAllViews{~std::uint64_t{0}, ~std::uint64_t{0}, ~std::uint64_t{0},
                                    ~std::uint64_t{0}};

/// Find the directions from which each point is seen.
///
/// scene    the surface; the points lie on it [m]
/// points   n positions [m]
/// normals  n outward unit vectors
/// offset   > 0 [m]: rays start this far along the normal, to miss the surface they start on
/// wanted   directions that are tried; the bits of all others stay 0
/// masks    n; bit d is set when normal . view_direction(d) > kMinViewCosine and the ray from the
///          point towards the camera meets nothing. NaN normals give an empty mask.
/// Rows are independent: any split into chunks gives the same bits. No allocation.
void compute_views(const RayScene& scene, PointsView points, NormalsView normals, float offset,
                   const ViewMask& wanted, std::span<ViewMask> masks);

/// Turn each normal to the outside, which is the side with more free views, and give its views.
///
/// As `compute_views`, but normals are correct up to their sign, as from an unreliable winding or a
/// plane fit. A normal is turned when the other side has more than twice the free views of this
/// one; otherwise it is kept: both sides of an open sheet are outside. An empty mask says that no
/// view reaches either side: the point is inside the object, drop it.
void orient_outward(const RayScene& scene, PointsView points, NormalsSpan normals, float offset,
                    std::span<ViewMask> masks);

}  // namespace trivet::kernels

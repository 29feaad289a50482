/// Errors of an estimated pose, as defined by the BOP benchmark.
///
/// Source: Hodan et al., BOP Challenge 2020, ECCVW 2020, section 2.2 (VSD, MSSD, MSPD).
#pragma once

#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "kernels/scans/pixel_window.hpp"
#include "storage/data/cloud.hpp"
#include "storage/data/model.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// List the transforms that map a model onto itself, the identity first.
///
/// A rotational axis becomes 315 = ceil(pi / 0.01) rotations: from one to the next no point moves
/// by more than 1 % of the diameter. If there are also discrete symmetries, each is combined with
/// every rotation.
std::vector<Eigen::Isometry3d> discretize_symmetry(const Symmetry& symmetry);

/// Maximum symmetry-aware surface distance: the largest distance between a vertex in both poses,
/// minimized over the symmetries.
///
/// vertices         n > 0 points of the model
/// estimate, truth  model to scene, in the vertices' unit
/// symmetries       symmetries of the model, with the identity (discretize_symmetry)
/// Returns a length in the vertices' unit. No allocation. Cost: n times the symmetries at most; a
/// symmetry is abandoned at the first vertex that makes it worse than the best one.
double mssd(PointsView vertices, const Eigen::Isometry3d& estimate, const Eigen::Isometry3d& truth,
            std::span<const Eigen::Isometry3d> symmetries) noexcept;

/// Maximum symmetry-aware projection distance: as `mssd`, between the vertices' images [pixel].
///
/// A vertex behind the camera is projected through its center as well; one in the plane z = 0 has
/// no image, which makes the error infinite.
double mspd(PointsView vertices, const Camera& camera, const Eigen::Isometry3d& estimate,
            const Eigen::Isometry3d& truth, std::span<const Eigen::Isometry3d> symmetries) noexcept;

/// Distances from the camera's center along the rays of a window's pixels; 0: no surface, as
/// outside the window.
struct DistanceMap {
  PixelWindow window;
  std::span<const float> distance;  // window.size() values, row-major

  float at(std::uint32_t u, std::uint32_t v) const noexcept {
    if (!window.contains(u, v)) return 0;
    return distance[std::size_t{v - window.top} * window.width + (u - window.left)];
  }
};

/// Whether a surface at this distance along a ray is visible: it exists (not 0), and it is at most
/// `delta` behind the measurement, or there is no measurement (0). Source: Hodan et al., ECCVW
/// 2020, section 2.2.
inline bool is_visible(float surface, float measured, double delta) noexcept {
  return surface > 0 &&
         (measured == 0 || static_cast<double>(surface) - static_cast<double>(measured) <= delta);
}

/// Convert depths along the optical axis to distances along the rays, in place.
///
/// camera  camera of the window (camera_of_window) whose rows have `width` pixels
void depths_to_distances(const Camera& camera, std::uint32_t width, std::span<float> depths);

struct VsdTolerances {
  /// Depth tolerance behind the measurement for visibility, in the unit of the distances; 15 mm in
  /// the benchmark.
  double delta;
  double diameter;               ///< diameter of the model, > 0
  std::span<const double> taus;  ///< tolerances [diameters]
};

/// Visible surface discrepancy, for several tolerances at once.
///
/// measured         the measured image as a whole; 0 without a measurement
/// estimate, truth  the model alone in either pose
/// errors           one per tolerance. Of the pixels where the model is visible in either pose, the
///                  share where it is visible in one only, or at distances that differ by tau or
///                  more; 1 if it is visible in neither pose
/// A surface is visible if nothing was measured more than delta in front of it; that of the
/// estimate also where the truth is. No allocation.
void vsd(const DistanceMap& measured, const DistanceMap& estimate, const DistanceMap& truth,
         const VsdTolerances& tolerances, std::span<double> errors);

}  // namespace trivet::kernels

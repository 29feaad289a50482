/// How far an estimated pose is from the true one, as the BOP benchmark measures it.
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

/// List the motions that map a model onto itself, the identity first.
///
/// A free axis becomes 315 = ceil(pi / 0.01) turns: from one to the next no point moves by more
/// than 1 % of the diameter. Beside discrete symmetries, every turn follows each of them.
std::vector<Eigen::Isometry3d> discretize_symmetry(const Symmetry& symmetry);

/// Maximum symmetry-aware surface distance: the largest distance between a vertex in both poses,
/// the smallest over the symmetries.
///
/// vertices         n > 0 points of the model
/// estimate, truth  model to scene, in the vertices' unit
/// symmetries       of the model, with the identity (discretize_symmetry)
/// Returns a length in the vertices' unit. No allocation. Cost: n times the symmetries at most; a
/// symmetry is left at the first vertex that makes it worse than the best one.
double mssd(PointsView vertices, const Eigen::Isometry3d& estimate, const Eigen::Isometry3d& truth,
            std::span<const Eigen::Isometry3d> symmetries) noexcept;

/// Maximum symmetry-aware projection distance: as `mssd`, between the vertices' images [pixel].
///
/// A vertex behind the camera is projected through its center all the same; one in the plane z = 0
/// has no image, which makes the error infinite.
double mspd(PointsView vertices, const Camera& camera, const Eigen::Isometry3d& estimate,
            const Eigen::Isometry3d& truth, std::span<const Eigen::Isometry3d> symmetries) noexcept;

/// Distances from the camera's center along the rays of a window's pixels; 0: nothing there, as
/// outside the window.
struct DistanceMap {
  PixelWindow window;
  std::span<const float> distance;  // window.size() values, row-major

  float at(std::uint32_t u, std::uint32_t v) const noexcept {
    if (!window.contains(u, v)) return 0;
    return distance[std::size_t{v - window.top} * window.width + (u - window.left)];
  }
};

/// Whether a surface is seen at its distance along a ray: it is there, 0 if not, and at most `delta`
/// behind what was measured, or nothing was (0). Source: Hodan et al., ECCVW 2020, section 2.2.
inline bool is_visible(float surface, float measured, double delta) noexcept {
  return surface > 0 &&
         (measured == 0 || static_cast<double>(surface) - static_cast<double>(measured) <= delta);
}

/// Turn depths along the optical axis into distances along the rays, in place.
///
/// camera  of the window (camera_of_window) that the rows of `width` pixels are
void depths_to_distances(const Camera& camera, std::uint32_t width, std::span<float> depths);

struct VsdTolerances {
  /// How far behind the measurement a surface still counts as visible, in the unit of the
  /// distances; 15 mm in the benchmark.
  double delta;
  double diameter;               ///< of the model, > 0
  std::span<const double> taus;  ///< tolerances [diameters]
};

/// Visible surface discrepancy, for several tolerances at once.
///
/// measured         what the sensor saw: the whole image; 0 without a measurement
/// estimate, truth  the model alone in either pose
/// errors           one a tolerance: the share of the pixels where the model is visible in either
///                  pose that see it in one only, or at distances that differ by tau or more; 1
///                  where it is visible in neither
/// A surface is visible where nothing was measured, or nothing more than delta in front of it; that
/// of the estimate also where the truth is. No allocation.
void vsd(const DistanceMap& measured, const DistanceMap& estimate, const DistanceMap& truth,
         const VsdTolerances& tolerances, std::span<double> errors);

}  // namespace trivet::kernels

/// Normals of an organized scan, with neighbors from its pixel grid.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "storage/common/columns.hpp"
#include "storage/data/cloud.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

struct GridNormalOptions {
  static constexpr std::uint32_t kMaxWindow = 20;
  std::uint32_t window = 3;         ///< half-width w [pixel], 1..20; larger is smoother and slower
  float gate = 2.0F;                ///< neighbors lie within gate * window * footprint, > 0
  std::uint32_t min_points = 6;     ///< points of a fit including its center, >= 3; fewer give NaN
  float max_obliquity_rad = 1.48F;  ///< largest angle between normal and line of sight; beyond it
                                    ///< NaN
  bool operator==(const GridNormalOptions&) const = default;
};

/// The points of a scan in image layout, with NaN for pixels without a point and around the image.
struct PixelPoints {
  static constexpr std::size_t kMargin = 32;  ///< >= kMaxWindow; keeps rows 64-byte aligned
  std::size_t width = 0, height = 0, stride = 0;
  Column<float> x, y, z;  ///< pixel (u, v) at (v + kMargin) * stride + u + kMargin

  std::size_t at(std::size_t u, std::size_t v) const noexcept {
    return (v + kMargin) * stride + u + kMargin;
  }
};

/// Arrange points as pixels. Allocates only if `out` is smaller than the image.
/// Pre: grid.point_index holds kNone or indices < points.size().
void arrange_pixels(const PixelGrid& grid, PointsView points, PixelPoints& out);

/// An organized scan.
struct GridScan {
  const PixelGrid& grid;      ///< point index of each pixel; each point at one pixel at most
  const PixelPoints& pixels;  ///< arrange_pixels(grid, points)
  Eigen::Vector3f viewpoint;  ///< position of the sensor, same frame and unit
};

/// Fit a plane around each pixel of some rows, and write the normals that face the sensor.
///
/// first_row, num_rows  rows of the image
/// normals              one unit vector per point of the scan, written for the points of these rows
/// residuals            RMS distance of each fit to its plane, unit of the points; or empty
///
/// A point in the (2 w + 1)^2 window is a neighbor if its distance from the center is within gate *
/// w * footprint. The footprint is the distance between neighboring pixels on the surface: the
/// larger of the distances to the nearer horizontal and the nearer vertical neighbor, at most 3
/// times the smaller. So the gate widens with range and slant. A depth step larger than the gate
/// never blends into a normal; smaller steps do. NaN in both outputs: fewer than min_points, no
/// neighboring pixel, collinear points, too oblique. No allocation or lock. Rows are independent:
/// any split into chunks gives the same bits. Cost: O((2 w + 1)^2) per pixel. Source: Hoppe et al.,
/// SIGGRAPH 1992, tangent plane estimation, on a gated window of pixels.
void estimate_normals_grid(const GridScan& scan, const GridNormalOptions& options,
                           std::size_t first_row, std::size_t num_rows, NormalsSpan normals,
                           std::span<float> residuals = {});

/// Estimate the noise of a scan across its surfaces: one standard deviation, unit of the points.
///
/// residuals  residuals of estimate_normals_grid with window w = 2, small enough that most surfaces
///            are flat within it; NaNs are ignored
/// scratch    overwritten
/// The estimate is the median of the residuals, which edges and curved parts in less than half of
/// the scan do not affect, times sqrt(n / (n - 3)) for the three parameters fitted to n = 25
/// points.
/// 0 without any residual. Cost: O(n).
float estimate_scan_noise(std::span<const float> residuals, Column<float>& scratch);

}  // namespace trivet::kernels

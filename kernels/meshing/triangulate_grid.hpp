/// A surface of triangles through an organized scan.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>

#include "storage/data/cloud.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

struct GridTriangulationOptions {
  /// Longest edge between neighboring pixels, in footprints: what the same pixels are apart on a
  /// surface that faces the sensor there; >= 1. With 5 a step in depth that is as steep as a
  /// surface seen at 78 degrees is a jump: what lies on its two sides hangs together no more.
  float max_jump = 5;
  /// Between a triangle's normal and the line of sight, above 0, below 90. A triangle beyond is
  /// more likely a step in depth between its pixels than a surface: at 80 degrees the sensor saw
  /// one point of it where it saw six of a surface that faces it, and errs in depth along it.
  float max_grazing_deg = 80;
  bool operator==(const GridTriangulationOptions&) const = default;
};

/// What became of the triangles that pixels side by side could span.
struct GridTriangulationStats {
  std::size_t num_jumps = 0;    ///< cut: an edge jumps in depth
  std::size_t num_grazing = 0;  ///< cut: seen at too grazing an angle, or without an area
  std::size_t num_behind = 0;   ///< cut: seen from behind; many where the viewpoint is wrong
};

/// Span triangles between the pixels of an organized scan.
///
/// grid       which point each pixel holds
/// points     n positions; pixels of points that are not finite count as empty
/// viewpoint  where the sensor stood, same frame and unit
/// noise      n standard deviations along the lines of sight, >= 0: edges and slopes that three of
///            them explain are not cut, as fine pixels of a noisy sensor show nothing but steps
/// Returns triangles over the points, counter-clockwise seen from the viewpoint: every edge is in
/// one of them or in two, in opposite directions. A square of four pixels gives two, split along
/// its shorter diagonal, so that one pixel beyond a step leaves the triangle of the other three;
/// three pixels give one. Turning or mirroring the image leaves the surface as it is, up to
/// diagonals of one length. Cost: O(pixels).
/// Source: Turk and Levoy, SIGGRAPH 1994; here the limit on edges grows with the distance.
Triangles triangulate_grid(const PixelGrid& grid, PointsView points,
                           const Eigen::Vector3f& viewpoint, std::span<const float> noise,
                           const GridTriangulationOptions& options = {},
                           GridTriangulationStats* stats = nullptr);

}  // namespace trivet::kernels

/// Surface reconstruction from an organized scan.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>

#include "storage/data/cloud.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

struct GridTriangulationOptions {
  /// Longest edge between neighboring pixels, >= 1, in footprints: the distance of the same pixels
  /// on a surface that faces the sensor there. With 5, a depth step as steep as a surface seen at
  /// 78 degrees is a discontinuity, and its two sides are not connected.
  float max_jump = 5;
  /// Largest angle between a triangle's normal and the line of sight, above 0, below 90. A triangle
  /// beyond it is more likely a depth step between its pixels than a surface: at 80 degrees the
  /// sensor sees one point for every six of a surface that faces it, and errs in depth along it.
  float max_grazing_deg = 80;
  bool operator==(const GridTriangulationOptions&) const = default;
};

/// Counts of the candidate triangles between neighboring pixels.
struct GridTriangulationStats {
  std::size_t num_jumps = 0;    ///< rejected: an edge crosses a depth discontinuity
  std::size_t num_grazing = 0;  ///< rejected: grazing angle of view, or zero area
  std::size_t num_behind = 0;   ///< rejected: seen from behind; many if the viewpoint is wrong
};

/// Connect the pixels of an organized scan by triangles.
///
/// grid       point index of each pixel
/// points     n positions; pixels of non-finite points count as empty
/// viewpoint  position of the sensor, same frame and unit
/// noise      n standard deviations along the lines of sight, >= 0. Edges and slopes within three
///            of them are not rejected, since fine pixels of a noisy sensor show nothing but steps
/// Returns triangles over the points, counter-clockwise seen from the viewpoint: every edge is in
/// one of them or in two, in opposite directions. A square of four pixels gives two triangles,
/// split along its shorter diagonal, so that one pixel beyond a step leaves the triangle of the
/// other three; three pixels give one. Rotating or mirroring the image does not change the surface,
/// except for diagonals of equal length. Cost: O(pixels).
/// Source: Turk and Levoy, SIGGRAPH 1994; here the limit on edges grows with the distance.
Triangles triangulate_grid(const PixelGrid& grid, PointsView points,
                           const Eigen::Vector3f& viewpoint, std::span<const float> noise,
                           const GridTriangulationOptions& options = {},
                           GridTriangulationStats* stats = nullptr);

}  // namespace trivet::kernels

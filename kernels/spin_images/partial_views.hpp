/// Visibility of the surface around a keypoint in partial views.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "kernels/common/voxel_hash.hpp"
#include "kernels/spin_images/support.hpp"
#include "storage/common/columns.hpp"

namespace trivet::kernels {

/// Bitmask of the views that see a point.
using ViewBits = std::uint64_t;
inline constexpr std::size_t kMostPartialViews = 64;

/// Number of points that share the area around each point, by view. Row v has one count per point,
/// at most 255, in the order of the grid from which supports are gathered.
struct Sharers {
  /// radius  > 0: points within it share an area
  Sharers(std::size_t num_points, float radius);

  std::size_t num_points;
  float radius;
  Column<std::uint8_t> counts;  ///< kMostPartialViews rows of num_points
  std::array<float, 256>
      areas{};  ///< area per point by count, for a disc of the radius; no visible point has count 0

  std::span<const std::uint8_t> of_view(std::size_t v) const noexcept {
    return std::span(counts).subspan(v * num_points, num_points);
  }
};

/// Count, for some points of a surface, the points within a radius that each view sees: the counts
/// of share_areas for a cloud of that view's points alone.
///
/// grid    grid of all points
/// views   views of all points
/// points  a subset: points [first, first + points.size()) of the rows of counts
/// sharers  counts of all points; those of the subset are written
/// No allocation, lock or throw. Rows are independent: any split into chunks gives the same bits.
void count_sharers(const VoxelHash& grid, std::span<const ViewBits> views, PointsView points,
                   std::size_t first, Sharers& sharers) noexcept;

/// The complete surface around a keypoint.
struct ViewedSupport {
  Eigen::Vector3f keypoint{0, 0, 0};
  Column<std::uint32_t> places;  ///< positions of its points in the grid's order
  std::size_t size = 0;
  /// Visibility of the points in each view: words of 64 points, the first view's first.
  Column<std::uint64_t> visible;
  std::size_t num_words = 0;

  std::span<const std::uint64_t> visible_in(std::size_t v) const noexcept {
    return std::span(visible).subspan(v * num_words, num_words);
  }
};

/// Gather the points of a grid within `radius` of a keypoint. Memory grows once.
///
/// views  views of all points, in the grid's order
void gather_viewed_support(const VoxelHash& grid, std::span<const ViewBits> views,
                           const Eigen::Vector3f& keypoint, float radius, ViewedSupport& support);

/// The visible part of the support in one view: the result of gather_support for that view's points
/// alone, with the areas of share_areas.
void extract_view(const VoxelHash& grid, const ViewedSupport& all, std::size_t view,
                  const Sharers& sharers, Support& support);

/// Similarity of the visible parts of a support between views.
struct LikeViews {
  std::array<ViewBits, kMostPartialViews> alike{};       ///< similar views of each view, including
                                                         ///< itself
  std::array<std::uint32_t, kMostPartialViews> sizes{};  ///< number of points visible in each view
};

/// Compare views of a support. Two are alike if the points visible in only one of them are at most
/// `share` of their average number of visible points. Only `wanted` views are compared and written.
void compare_views(const ViewedSupport& all, ViewBits wanted, float share,
                   LikeViews& views) noexcept;

/// The view among `left` that is like most others of them; the first of several. Pre: left != 0.
std::size_t most_typical(const LikeViews& views, ViewBits left) noexcept;

}  // namespace trivet::kernels

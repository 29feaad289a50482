/// What partial views see of the surface around a keypoint.
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

/// Views that see a point, one bit each.
using ViewBits = std::uint64_t;
inline constexpr std::size_t kMostPartialViews = 64;

/// How many points share the area around each, by view: row v has a count a point, 255 at most, in the
/// order of the grid that supports are gathered from.
struct Sharers {
  /// radius  > 0: points this near share an area
  Sharers(std::size_t num_points, float radius);

  std::size_t num_points;
  float radius;
  Column<std::uint8_t> counts;  ///< kMostPartialViews rows of num_points
  std::array<float, 256>
      areas{};  ///< by count, of a disc of the radius; no point that is seen has 0

  std::span<const std::uint8_t> of_view(std::size_t v) const noexcept {
    return std::span(counts).subspan(v * num_points, num_points);
  }
};

/// Count, for some points of a surface, those within a radius that each view sees: what share_areas
/// counts where the view's points are all there are.
///
/// grid    of all points
/// views   of all points
/// points  some, those [first, first + points.size()) of the rows of counts
/// sharers  of all points; those of the points are written
/// No allocation, lock or throw. Rows are independent: any split into chunks gives the same bits.
void count_sharers(const VoxelHash& grid, std::span<const ViewBits> views, PointsView points,
                   std::size_t first, Sharers& sharers) noexcept;

/// The surface around a keypoint, all of it.
struct ViewedSupport {
  Eigen::Vector3f keypoint{0, 0, 0};
  Column<std::uint32_t> places;  ///< of its points, in the grid's order
  std::size_t size = 0;
  /// Which of the points each view sees: words of 64 points, the first view's first.
  Column<std::uint64_t> seen;
  std::size_t num_words = 0;

  std::span<const std::uint64_t> seen_by(std::size_t v) const noexcept {
    return std::span(seen).subspan(v * num_words, num_words);
  }
};

/// Gather the points of a grid within `radius` of a keypoint. Grows to what it needs once.
///
/// views  of all points, in the grid's order
void gather_viewed_support(const VoxelHash& grid, std::span<const ViewBits> views,
                           const Eigen::Vector3f& keypoint, float radius, ViewedSupport& support);

/// What one view sees of it, as gather_support gives it for the view's points alone, with the areas
/// that share_areas gives them.
void take_view(const VoxelHash& grid, const ViewedSupport& all, std::size_t view,
               const Sharers& sharers, Support& support);

/// Which views see nearly the same of a support.
struct LikeViews {
  std::array<ViewBits, kMostPartialViews> alike{};       ///< of each view, itself among them
  std::array<std::uint32_t, kMostPartialViews> sizes{};  ///< points that each sees
};

/// Compare views of a support: two are alike where the points that only one of them sees are at most
/// `share` of what they see on average. Only `wanted` views are compared and written.
void compare_views(const ViewedSupport& all, ViewBits wanted, float share,
                   LikeViews& views) noexcept;

/// Of some views, the one that most others of them are like; the first of several. Pre: left != 0.
std::size_t most_typical(const LikeViews& views, ViewBits left) noexcept;

}  // namespace trivet::kernels

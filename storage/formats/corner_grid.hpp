/// Spatial index of a polygon's corners, to find those in a triangle without testing all.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "storage/common/clamped_integer.hpp"

namespace trivet::formats {

/// A position in the plane of a polygon.
struct PlanePoint {
  double x = 0, y = 0;
};

/// A grid of squares, about as many as corners.
class CornerGrid {
 public:
  /// Sort corners into the grid, replacing previous ones. Any `Corner` has x and y.
  template <class Corner>
  void fill(std::span<const Corner> corners) {
    if (corners.empty()) return;
    PlanePoint low{corners[0].x, corners[0].y}, high = low;
    for (const Corner& c : corners) {
      low = {std::min(low.x, c.x), std::min(low.y, c.y)};
      high = {std::max(high.x, c.x), std::max(high.y, c.y)};
    }
    lay_out(low, high, corners.size());

    // Counting sort: count, add up, fill.
    firsts_.assign(columns_ * rows_ + 1, 0);
    for (const Corner& c : corners) ++firsts_[cell_of(c.x, c.y) + 1];
    for (std::size_t cell = 0; cell + 1 < firsts_.size(); ++cell)
      firsts_[cell + 1] += firsts_[cell];
    next_.assign(firsts_.begin(), firsts_.end() - 1);
    corners_.resize(corners.size());
    for (std::uint32_t i = 0; i < corners.size(); ++i)
      corners_[next_[cell_of(corners[i].x, corners[i].y)]++] = i;
  }

  /// Visit runs of corner indices that together include all corners in a triangle, and some around
  /// it. `visit` returns whether to continue. Returns the last result of `visit`.
  template <class Visit>
  bool visit(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c, Visit&& visit) const {
    const std::size_t last_row = row_of(std::max({a.y, b.y, c.y}));
    for (std::size_t row = row_of(std::min({a.y, b.y, c.y})); row <= last_row; ++row) {
      const auto [left, right] = reach_in_row(row, a, b, c);
      // One extra square on both sides covers rounding errors.
      const std::size_t first = column_of(left - side_), last = column_of(right + side_);
      const std::span<const std::uint32_t> run = std::span(corners_).subspan(
          firsts_[row * columns_ + first],
          firsts_[row * columns_ + last + 1] - firsts_[row * columns_ + first]);
      if (!visit(run)) return false;
    }
    return true;
  }

 private:
  struct Reach {
    double left, right;
  };

  void lay_out(const PlanePoint& low, const PlanePoint& high, std::size_t num_corners);
  Reach reach_in_row(std::size_t row, const PlanePoint& a, const PlanePoint& b,
                     const PlanePoint& c) const;

  std::size_t column_of(double x) const {
    return clamped_integer((x - low_.x) / side_, std::size_t{0}, columns_ - 1);
  }
  std::size_t row_of(double y) const {
    return clamped_integer((y - low_.y) / side_, std::size_t{0}, rows_ - 1);
  }
  std::size_t cell_of(double x, double y) const { return row_of(y) * columns_ + column_of(x); }

  PlanePoint low_;
  double side_ = 1;  // side of a square
  std::size_t columns_ = 1, rows_ = 1;
  std::vector<std::uint32_t> firsts_, next_, corners_;  // corners of square k start at
                                                        // corners_[firsts_[k]]
};

}  // namespace trivet::formats

#include "storage/formats/corner_grid.hpp"

#include <array>
#include <cmath>
#include <limits>

namespace trivet::formats {
namespace {

constexpr std::size_t kFewCorners = 32;  // number tested one by one

}  // namespace

void CornerGrid::lay_out(const PlanePoint& low, const PlanePoint& high, std::size_t num_corners) {
  low_ = low;
  side_ = 1;
  columns_ = rows_ = 1;
  const double width = high.x - low.x, height = high.y - low.y;
  const auto n = static_cast<double>(num_corners);
  const double side = std::max(std::sqrt(width / n * height), std::max(width, height) / n);
  if (num_corners < kFewCorners || !(side > 0) || !std::isfinite(side)) return;
  side_ = side;
  columns_ = clamped_integer(width / side, std::size_t{0}, num_corners) + 1;
  rows_ = clamped_integer(height / side, std::size_t{0}, num_corners) + 1;
}

CornerGrid::Reach CornerGrid::reach_in_row(std::size_t row, const PlanePoint& a,
                                           const PlanePoint& b, const PlanePoint& c) const {
  Reach all{std::min({a.x, b.x, c.x}), std::max({a.x, b.x, c.x})};
  if (rows_ == 1) return all;
  const double bottom = low_.y + static_cast<double>(row) * side_, top = bottom + side_;
  Reach reach{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  const auto extend = [&](double x) {
    reach = {std::min(reach.left, x), std::max(reach.right, x)};
  };
  const std::array<const PlanePoint*, 4> outline{&a, &b, &c, &a};
  for (std::size_t k = 0; k < 3; ++k) {
    const PlanePoint &from = *outline[k], &to = *outline[k + 1];
    if (from.y >= bottom && from.y <= top) extend(from.x);
    for (const double y : {bottom, top}) {
      const double along = (y - from.y) / (to.y - from.y);  // NaN or infinite for a horizontal edge
      if (along >= 0 && along <= 1) extend(from.x + along * (to.x - from.x));
    }
  }
  // Rounding may place a triangle's end beside its row.
  return reach.left <= reach.right ? reach : all;
}

}  // namespace trivet::formats

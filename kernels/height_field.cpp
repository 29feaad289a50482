#include "kernels/height_field.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace trivet::kernels {

HeightField::HeightField(float half_side, float cell)
    : half_side_(half_side),
      cell_(cell),
      side_(static_cast<std::ptrdiff_t>(std::ceil(2 * half_side / cell))) {
  assert(half_side > 0 && cell > 0 && "a grid of some extent");
  top_.assign(static_cast<std::size_t>(side_ * side_), 0.0F);
}

std::ptrdiff_t HeightField::cell_of(float coordinate) const noexcept {
  const float cells = std::floor((coordinate + half_side_) / cell_);
  // Far outside stays outside, without overflow.
  return static_cast<std::ptrdiff_t>(std::clamp(cells, -2.0F, static_cast<float>(side_) + 1));
}

float HeightField::rest(PointsView samples) const noexcept {
  float lift = -std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const std::ptrdiff_t u = cell_of(samples.x[i]), v = cell_of(samples.y[i]);
    float highest = 0;
    for (std::ptrdiff_t y = std::max<std::ptrdiff_t>(v - 1, 0); y <= std::min(v + 1, side_ - 1);
         ++y) {
      for (std::ptrdiff_t x = std::max<std::ptrdiff_t>(u - 1, 0); x <= std::min(u + 1, side_ - 1);
           ++x) {
        highest = std::max(highest, top_[static_cast<std::size_t>(y * side_ + x)]);
      }
    }
    lift = std::max(lift, highest - samples.z[i]);
  }
  return lift;
}

void HeightField::add(PointsView samples, float lift) noexcept {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const std::ptrdiff_t u = cell_of(samples.x[i]), v = cell_of(samples.y[i]);
    if (u < 0 || v < 0 || u >= side_ || v >= side_) continue;
    float& top = top_[static_cast<std::size_t>(v * side_ + u)];
    top = std::max(top, samples.z[i] + lift);
  }
}

}  // namespace trivet::kernels

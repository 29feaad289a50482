#include "kernels/simulation/drop_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernels/common/counter_random.hpp"
#include "storage/common/precondition.hpp"

namespace trivet::kernels {
namespace {

constexpr std::uint64_t kThinning = 0x7468;  // a stream of random numbers, see add_noise.cpp

/// Coordinate of a point along a direction; the same bits in every call.
float along(const Eigen::Vector3f& direction, PointsView points, std::size_t i) noexcept {
  return direction.x() * points.x[i] + direction.y() * points.y[i] + direction.z() * points.z[i];
}

}  // namespace

void keep_at_random(double share, std::uint64_t seed, std::size_t first,
                    std::span<std::uint8_t> keep) noexcept {
  for (std::size_t i = 0; i < keep.size(); ++i)
    if (CounterRandom(seed, kThinning, first + i).uniform() >= share) keep[i] = 0;
}

void drop_half_space(PointsView points, const HalfSpace& gone, std::span<std::uint8_t> keep) {
  TRIVET_REQUIRE(keep.size() == points.size(), "one mark a point");
  for (std::size_t i = 0; i < points.size(); ++i)
    if (along(gone.direction, points, i) > gone.offset) keep[i] = 0;
}

HalfSpace cut_share(PointsView points, const Eigen::Vector3f& direction, double share,
                    std::span<float> scratch) {
  TRIVET_REQUIRE(scratch.size() == points.size(), "one number a point");
  const std::size_t n = points.size();
  const auto num_gone =
      static_cast<std::size_t>(std::floor(std::clamp(share, 0.0, 1.0) * static_cast<double>(n)));
  if (num_gone == n) return {direction, -std::numeric_limits<float>::infinity()};
  for (std::size_t i = 0; i < n; ++i) scratch[i] = along(direction, points, i);
  const auto last_kept = scratch.begin() + static_cast<std::ptrdiff_t>(n - num_gone - 1);
  std::nth_element(scratch.begin(), last_kept, scratch.end());
  return {direction, *last_kept};
}

}  // namespace trivet::kernels

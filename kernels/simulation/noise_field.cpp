#include "kernels/simulation/noise_field.hpp"

#include <array>
#include <cmath>

#include "kernels/common/counter_random.hpp"

namespace trivet::kernels {
namespace {

/// Weights of four knots at a position 0..1 between the middle two.
std::array<double, 4> spline(double t) noexcept {
  const double s = 1 - t;
  return {s * s * s / 6, (4 - 6 * t * t + 3 * t * t * t) / 6, (4 - 6 * s * s + 3 * s * s * s) / 6,
          t * t * t / 6};
}

// Mean over a cell of the sum of the squared weights along one axis.
constexpr double kMeanSquare = 151.0 / 315;

}  // namespace

NoiseField::NoiseField(std::uint32_t width, std::uint32_t height, double length_pixel,
                       std::uint64_t seed, std::uint64_t stream, std::uint64_t first_item)
    : spacing_(length_pixel / 2),
      columns_(static_cast<std::size_t>(width / spacing_) + 4),
      knots_(columns_ * (static_cast<std::size_t>(height / spacing_) + 4)) {
  for (std::size_t i = 0; i < knots_.size(); ++i)
    knots_[i] = static_cast<float>(CounterRandom(seed, stream, first_item + i).normal());
}

double NoiseField::at(double u, double v) const noexcept {
  const double x = u / spacing_, y = v / spacing_;
  const auto column = static_cast<std::size_t>(x), row = static_cast<std::size_t>(y);
  const std::array<double, 4> across = spline(x - static_cast<double>(column)),
                              down = spline(y - static_cast<double>(row));
  double sum = 0;
  for (std::size_t j = 0; j < 4; ++j) {
    const float* knot = knots_.data() + (row + j) * columns_ + column;
    for (std::size_t i = 0; i < 4; ++i) sum += down[j] * across[i] * static_cast<double>(knot[i]);
  }
  return sum / kMeanSquare;
}

}  // namespace trivet::kernels

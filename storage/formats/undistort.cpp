#include "storage/formats/undistort.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace trivet::formats {
namespace {

/// Pixels with a larger depth difference are two surfaces: in distances of neighboring pixels, a
/// slope of 72 degrees.
constexpr double kSteepest = 3;

class Sampler {
 public:
  Sampler(std::span<const float> raw, std::uint32_t width, std::uint32_t height,
          const Camera& camera)
      : raw_(raw),
        width_(width),
        height_(height),
        steepest_(kSteepest / std::min(camera.fx, camera.fy)) {}

  float operator()(double u, double v) const {
    if (!(u > -0.5 && v > -0.5 && u < width_ - 0.5 && v < height_ - 0.5)) return 0;
    const float nearest = at(static_cast<std::size_t>(u + 0.5), static_cast<std::size_t>(v + 0.5));
    if (!(nearest > 0) || !(u >= 0 && v >= 0 && u < width_ - 1.0 && v < height_ - 1.0))
      return std::max(nearest, 0.0F);
    const auto left = static_cast<std::size_t>(u), top = static_cast<std::size_t>(v);
    const std::array around{at(left, top), at(left + 1, top), at(left, top + 1),
                            at(left + 1, top + 1)};
    const auto [low, high] = std::minmax_element(around.begin(), around.end());
    if (!(*low > 0) || !(*high - *low <= steepest_ * *low)) return nearest;
    const double right = u - static_cast<double>(left), down = v - static_cast<double>(top);
    const double inverse = (1 - down) * ((1 - right) / around[0] + right / around[1]) +
                           down * ((1 - right) / around[2] + right / around[3]);
    return static_cast<float>(1 / inverse);
  }

 private:
  float at(std::size_t u, std::size_t v) const { return raw_[v * width_ + u]; }

  std::span<const float> raw_;
  std::uint32_t width_, height_;
  double steepest_;  ///< relative to the depth
};

}  // namespace

std::optional<std::pair<double, double>> distort(const LensDistortion& lens, double x,
                                                 double y) noexcept {
  const auto& [k1, k2, p1, p2, k3, k4, k5, k6] = lens;
  const double s = x * x + y * y;
  const double above = 1 + s * (k1 + s * (k2 + s * k3)), below = 1 + s * (k4 + s * (k5 + s * k6));
  const double above_slope = k1 + s * (2 * k2 + s * 3 * k3),
               below_slope = k4 + s * (2 * k5 + s * 3 * k6);
  const double scale = above / below;
  // The radius r * scale(r^2) must increase with r.
  const double growth = scale + 2 * s * (above_slope - scale * below_slope) / below;
  if (!(below > 0) || !(growth > 0)) return std::nullopt;
  return std::pair{x * scale + 2 * p1 * x * y + p2 * (s + 2 * x * x),
                   y * scale + p1 * (s + 2 * y * y) + 2 * p2 * x * y};
}

std::vector<float> undistort(std::span<const float> raw, std::uint32_t width, std::uint32_t height,
                             const Camera& camera) {
  const Sampler sample(raw, width, height, camera);
  std::vector<float> pinhole(raw.size(), 0);
  for (std::size_t pixel = 0; pixel < pinhole.size(); ++pixel) {
    const double x = (static_cast<double>(pixel % width) - camera.cx) / camera.fx;
    const double y = (static_cast<double>(pixel / width) - camera.cy) / camera.fy;
    const auto bent = distort(camera.distortion, x, y);
    if (!bent) continue;
    pinhole[pixel] =
        sample(camera.fx * bent->first + camera.cx, camera.fy * bent->second + camera.cy);
  }
  return pinhole;
}

}  // namespace trivet::formats

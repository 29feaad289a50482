#include "kernels/scans/correlated_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "kernels/common/median.hpp"
#include "kernels/common/slope_fit.hpp"
#include "storage/common/stop.hpp"

namespace trivet::kernels {
namespace {

// Ratio of the mean length of normal 2-vectors to its root mean square, sqrt(pi) / 2.
constexpr double kMeanLength = 0.886;

/// Sums over the pixels of a window or patch; r is the distance from the plane.
struct Sums : SlopeSums {
  double rr = 0;

  void add(double at_x, double at_y, double across) noexcept {
    n += 1;
    x += at_x;
    y += at_y;
    xx += at_x * at_x;
    xy += at_x * at_y;
    yy += at_y * at_y;
    r += across;
    rx += across * at_x;
    ry += across * at_y;
    rr += across * across;
  }
  Sums& operator+=(const Sums& o) noexcept {
    n += o.n;
    x += o.x;
    y += o.y;
    xx += o.xx;
    xy += o.xy;
    yy += o.yy;
    r += o.r;
    rx += o.rx;
    ry += o.ry;
    rr += o.rr;
    return *this;
  }
};

/// Variances in excess of independent noise; the slope is per pixel.
struct Patch {
  double height, slope, footprint;
};

class Patches {
 public:
  Patches(const RangeImage& image, std::span<const Plane> planes, std::size_t window)
      : image_(image), planes_(planes), window_(window) {}

  /// The patch with this upper left pixel, if it lies on one plane.
  std::optional<Patch> measure(std::size_t u0, std::size_t v0) const {
    const std::size_t side = kPatch * window_;
    const std::size_t width = image_.geometry.width;
    const std::uint8_t label = image_.near_plane[(v0 + side / 2) * width + u0 + side / 2];
    if (label == 0) return std::nullopt;
    std::array<Sums, kPatch * kPatch> windows;
    Sums all;
    for (std::size_t k = 0; k < windows.size(); ++k) {
      windows[k] = sum(u0, v0, k % kPatch * window_, k / kPatch * window_, label);
      all += windows[k];
    }
    if (all.n < 0.8 * static_cast<double>(side * side)) return std::nullopt;
    const SlopeFit plane = fit_slope(all);
    const auto full = static_cast<double>(window_ * window_);
    double count = 0, means = 0, slopes = 0, within = 0, spread = 0;
    for (const Sums& window : windows) {
      if (window.n < full) continue;
      const SlopeFit own = fit_slope(window);
      const double dx = window.x / window.n - all.x / all.n,
                   dy = window.y / window.n - all.y / all.n;
      const double mean = window.r / full - all.r / all.n - plane.gx * dx - plane.gy * dy;
      const double gx = own.gx - plane.gx, gy = own.gy - plane.gy;
      count += 1;
      means += mean * mean;
      slopes += gx * gx + gy * gy;
      within += (window.rr - window.r * window.r / full - own.explained) / (full - 3);
      spread = (own.xx + own.yy) / (2 * full);
    }
    if (count < 0.5 * static_cast<double>(windows.size())) return std::nullopt;
    const double noise = within / count;
    const std::size_t middle = (v0 + side / 2) * width + u0 + side / 2;
    return Patch{means / count - noise / full, slopes / count - 2 * noise / (full * spread),
                 static_cast<double>(image_.depth[middle] / image_.geometry.fx)};
  }

 private:
  Sums sum(std::size_t u0, std::size_t v0, std::size_t du, std::size_t dv,
           std::uint8_t label) const noexcept {
    Sums sums;
    const Plane& plane = planes_[label - 1U];
    for (std::size_t y = dv; y < dv + window_; ++y) {
      for (std::size_t x = du; x < du + window_; ++x) {
        const std::size_t pixel = (v0 + y) * image_.geometry.width + u0 + x;
        if (image_.near_plane[pixel] != label) continue;
        const Eigen::Vector3f p = image_.geometry.back_project(pixel, image_.depth[pixel]);
        sums.add(static_cast<double>(x), static_cast<double>(y),
                 static_cast<double>(plane.normal.dot(p) - plane.offset));
      }
    }
    return sums;
  }

  const RangeImage& image_;
  std::span<const Plane> planes_;
  std::size_t window_;
};

}  // namespace

CorrelatedNoise measure_correlated_noise(const RangeImage& image, std::span<const Plane> planes,
                                         std::size_t window) {
  const Patches patches(image, planes, window);
  const std::size_t side = kPatch * window;
  std::vector<double> heights, slopes;
  for (std::size_t v = 0; v + side <= image.geometry.height; v += side) {
    check_stop();
    for (std::size_t u = 0; u + side <= image.geometry.width; u += side) {
      const std::optional<Patch> patch = patches.measure(u, v);
      if (!patch) continue;
      heights.push_back(patch->height);
      slopes.push_back(patch->slope / (patch->footprint * patch->footprint));
    }
  }
  if (heights.size() < kFewestPatches) return {};
  return {static_cast<float>(std::sqrt(std::max(0.0, median(std::span(heights))))),
          static_cast<float>(
              std::atan(kMeanLength * std::sqrt(std::max(0.0, median(std::span(slopes))))))};
}

}  // namespace trivet::kernels

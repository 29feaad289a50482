#include "kernels/spin_images/spin_image.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "storage/common/simd.hpp"

namespace trivet::kernels {
namespace {

constexpr std::size_t kStride = 16;
using FourFloats [[gnu::vector_size(16)]] = float;

TRIVET_SIMD_CLONES
void find_bins(const Support& support, const Eigen::Vector3f& axis, float bins_per_unit,
               SpinScratch& scratch) noexcept {
  constexpr float kLast = kSpinBins - 1;
  const float *xs = support.x.data(), *ys = support.y.data(), *zs = support.z.data(),
              *areas = support.area.data();
  float* const weights = scratch.weights.data();
  std::int32_t* const bins = scratch.bins.data();
  const float ax = axis.x(), ay = axis.y(), az = axis.z();
  const std::size_t n = support.size;
  TRIVET_SIMD_LOOP
  for (std::size_t k = 0; k < n; ++k) {
    const float x = xs[k], y = ys[k], z = zs[k];
    const float beta = ax * x + (ay * y + az * z);
    const float squared = x * x + (y * y + z * z) - beta * beta;
    const float alpha = std::sqrt(std::max(0.0F, squared));
    const float u = std::clamp(0.5F * kLast - 0.5F * bins_per_unit * beta, 0.0F, kLast);
    const float v = std::min(bins_per_unit * alpha, kLast);
    const auto i = static_cast<std::int32_t>(u), j = static_cast<std::int32_t>(v);
    const float a = u - static_cast<float>(i), c = v - static_cast<float>(j);
    const float area = areas[k];
    weights[4 * k] = area * ((1 - a) * (1 - c));
    weights[4 * k + 1] = area * ((1 - a) * c);
    weights[4 * k + 2] = area * (a * (1 - c));
    weights[4 * k + 3] = area * (a * c);
    bins[k] = i * static_cast<std::int32_t>(kStride) + j;
  }
}

TRIVET_SIMD_CLONES
void scale_to_roots(float* image, float scale) noexcept {
  for (std::size_t i = 0; i < kSpinImageSize; ++i) image[i] = std::sqrt(scale * image[i]);
}

}  // namespace

void spin_image(const Support& support, const Eigen::Vector3f& axis, float radius,
                std::span<float, kSpinImageSize> image, SpinScratch& scratch) {
  const std::size_t n = support.size;
  if (scratch.bins.size() < n) {
    scratch.weights.resize(4 * n);
    scratch.bins.resize(n);
  }
  find_bins(support, axis, static_cast<float>(kSpinBins - 1) / radius, scratch);
  // Each bin accumulates for itself and the three bins after it, so that a point adds four numbers
  // at one address. If neighbors added to half-overlapping addresses, each would wait for the one
  // before.
  alignas(64) std::array<FourFloats, kSpinBins * kStride> shares{};
  for (std::size_t k = 0; k < n; ++k) {
    FourFloats weights;
    __builtin_memcpy(&weights, scratch.weights.data() + 4 * k, sizeof(weights));
    shares[static_cast<std::size_t>(scratch.bins[k])] += weights;
  }
  const auto share = [&](std::size_t i, std::size_t j, std::size_t part) {
    return shares[i * kStride + j][part];
  };
  for (std::size_t i = 0; i < kSpinBins; ++i) {
    for (std::size_t j = 0; j < kSpinBins; ++j) {
      float sum = share(i, j, 0);
      if (j > 0) sum += share(i, j - 1, 1);
      if (i > 0) sum += share(i - 1, j, 2);
      if (i > 0 && j > 0) sum += share(i - 1, j - 1, 3);
      image[i * kSpinBins + j] = sum;
    }
  }
}

void normalize_spin_image(std::span<float, kSpinImageSize> image) noexcept {
  constexpr std::size_t kLanes = 8, kFull = kSpinImageSize / kLanes * kLanes;
  std::array<double, kLanes> sums{};
  for (std::size_t i = 0; i < kFull; i += kLanes) {
    for (std::size_t k = 0; k < kLanes; ++k) sums[k] += static_cast<double>(image[i + k]);
  }
  for (std::size_t i = kFull; i < kSpinImageSize; ++i)
    sums[i - kFull] += static_cast<double>(image[i]);
  const double sum = std::accumulate(sums.begin(), sums.end(), 0.0);
  if (!(sum > 0)) return;
  scale_to_roots(image.data(), static_cast<float>(1 / sum));
}

}  // namespace trivet::kernels

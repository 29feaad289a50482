#include "kernels/spin_images/spin_image.hpp"

#include <algorithm>
#include <cmath>

#include "storage/simd.hpp"

namespace trivet::kernels {
namespace {

constexpr std::size_t kStride = 16;
using FourFloats [[gnu::vector_size(16)]] = float;

TRIVET_SIMD_CLONES
void find_bins(const float* __restrict xs, const float* __restrict ys, const float* __restrict zs,
               const float* __restrict areas, std::size_t n, float ax, float ay, float az,
               float bins_per_unit, float* __restrict weights,
               std::int32_t* __restrict bins) noexcept {
  constexpr float kLast = kSpinBins - 1;
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

}  // namespace

void spin_image(const Support& support, const Eigen::Vector3f& axis, float radius,
                std::span<float, kSpinImageSize> image, SpinScratch& scratch) {
  const std::size_t n = support.size;
  if (scratch.bins.size() < n) {
    scratch.weights.resize(4 * n);
    scratch.bins.resize(n);
  }
  find_bins(support.x.data(), support.y.data(), support.z.data(), support.area.data(), n, axis.x(),
            axis.y(), axis.z(), static_cast<float>(kSpinBins - 1) / radius, scratch.weights.data(),
            scratch.bins.data());
  // Each bin collects for itself and the three bins after it, so that a point adds four numbers in
  // one place: where neighbors add to places that half overlap, each waits for the one before.
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
  double sum = 0;
  for (const float value : image) sum += static_cast<double>(value);
  if (!(sum > 0)) return;
  const auto scale = static_cast<float>(1 / sum);
  for (float& value : image) value = std::sqrt(scale * value);
}

}  // namespace trivet::kernels

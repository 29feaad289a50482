#include "kernels/spin_image.hpp"

#include <algorithm>
#include <cmath>

#include "storage/simd.hpp"

namespace trivet::kernels {
namespace {

constexpr std::size_t kStride = 16;  // one bin more than there are: its weight is 0
using TwoFloats [[gnu::vector_size(8)]] = float;

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
  alignas(64) std::array<float, (kSpinBins + 1) * kStride> padded{};
  for (std::size_t k = 0; k < n; ++k) {
    float* const at = padded.data() + scratch.bins[k];
    TwoFloats here, next, add_here, add_next;
    __builtin_memcpy(&here, at, sizeof(here));
    __builtin_memcpy(&next, at + kStride, sizeof(next));
    __builtin_memcpy(&add_here, scratch.weights.data() + 4 * k, sizeof(add_here));
    __builtin_memcpy(&add_next, scratch.weights.data() + 4 * k + 2, sizeof(add_next));
    here += add_here;
    next += add_next;
    __builtin_memcpy(at, &here, sizeof(here));
    __builtin_memcpy(at + kStride, &next, sizeof(next));
  }
  for (std::size_t i = 0; i < kSpinBins; ++i)
    std::copy_n(padded.data() + i * kStride, kSpinBins, image.data() + i * kSpinBins);
}

void normalise_spin_image(std::span<float, kSpinImageSize> image) noexcept {
  double sum = 0;
  for (const float value : image) sum += static_cast<double>(value);
  if (!(sum > 0)) return;
  const auto scale = static_cast<float>(1 / sum);
  for (float& value : image) value = std::sqrt(scale * value);
}

}  // namespace trivet::kernels

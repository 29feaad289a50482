#include "kernels/common/projector.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "storage/common/precondition.hpp"
#include "storage/common/simd.hpp"

namespace trivet::kernels {
namespace {

constexpr std::size_t kLanes = 32;                    // products summed at a time
constexpr std::size_t kVectors = 2, kComponents = 4;  // size of a multiplied tile
// Number of vectors per pass over the components; they stay in the first-level cache.
constexpr std::size_t kVectorsInCache = 8;
constexpr int kBits = 15;
constexpr int kLeastExponent = -90;  // limit for shorter vectors, whose squares underflow

constexpr std::size_t filled_up(std::size_t n, std::size_t block) noexcept {
  return (n + block - 1) / block * block;
}

std::int16_t round_to_16_bits(float value) noexcept {
  constexpr float kMost = 32767;
  return static_cast<std::int16_t>(std::clamp(value + (value < 0 ? -0.5F : 0.5F), -kMost, kMost));
}

/// Dot products of kVectors and kComponents, each of n numbers, n a multiple of kLanes.
TRIVET_SIMD_CLONES
void multiply(const std::int16_t* __restrict vectors, const std::int16_t* __restrict components,
              std::size_t n, std::array<std::int32_t, kVectors * kComponents>& out) noexcept {
  n = n / kLanes * kLanes;
  const std::int16_t* __restrict v0 = vectors, * __restrict v1 = v0 + n;
  const std::int16_t* __restrict c0 = components, * __restrict c1 = c0 + n, * __restrict c2 = c1 + n, * __restrict c3 = c2 + n;
  std::int32_t sum00 = 0, sum01 = 0, sum02 = 0, sum03 = 0;
  std::int32_t sum10 = 0, sum11 = 0, sum12 = 0, sum13 = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::int32_t a = v0[i], b = v1[i];
    sum00 += a * c0[i];
    sum01 += a * c1[i];
    sum02 += a * c2[i];
    sum03 += a * c3[i];
    sum10 += b * c0[i];
    sum11 += b * c1[i];
    sum12 += b * c2[i];
    sum13 += b * c3[i];
  }
  out = {sum00, sum01, sum02, sum03, sum10, sum11, sum12, sum13};
}

/// Convert a vector minus the mean to integers; returns the value of one unit, 0 if the vector
/// equals the mean.
TRIVET_SIMD_CLONES
float write_rounded(const float* __restrict vector, const float* __restrict mean, std::size_t n,
                    float* __restrict less, std::int16_t* __restrict out) noexcept {
  std::array<float, 16> squares{};  // in lanes: the same order for any width
  for (std::size_t i = 0; i < n; ++i) less[i] = vector[i] - mean[i];
  const std::size_t num_in_blocks = n / squares.size() * squares.size();
  for (std::size_t i = 0; i < num_in_blocks; i += squares.size()) {
    for (std::size_t k = 0; k < squares.size(); ++k) squares[k] += less[i + k] * less[i + k];
  }
  for (std::size_t i = num_in_blocks; i < n; ++i) squares[i - num_in_blocks] += less[i] * less[i];
  float squared = 0;
  for (const float lane : squares) squared += lane;
  // 2^exponent exceeds the length, to which rounding adds, by a factor of at most 2.
  int exponent = 0;
  std::frexp(std::sqrt(squared) * 1.01F, &exponent);
  exponent = std::max(exponent, kLeastExponent);
  const float scale = std::ldexp(1.0F, kBits - exponent);
  for (std::size_t i = 0; i < n; ++i) {
    const float value = less[i] * scale;
    out[i] =
        static_cast<std::int16_t>(static_cast<std::int32_t>(value + (value < 0 ? -0.5F : 0.5F)));
  }
  return squared > 0 ? std::ldexp(1.0F, exponent - 2 * kBits) : 0;
}

}  // namespace

Projector::Projector(const PcaBasis& basis)
    : num_components_(basis.size()),
      stride_(filled_up(basis.dimension, kLanes)),
      mean_(basis.mean),
      components_(filled_up(basis.size(), kComponents) * stride_) {
  TRIVET_REQUIRE(basis.dimension <= kMostNumbers, "vectors are longer than expected");
  for (std::size_t c = 0; c < num_components_; ++c) {
    for (std::size_t i = 0; i < basis.dimension; ++i)
      components_[c * stride_ + i] =
          round_to_16_bits(std::ldexp(basis.components[c * basis.dimension + i], kBits));
  }
}

void Projector::project(std::span<const float> vectors, std::span<float> out) const {
  const std::size_t d = dimension(), k = num_components_;
  if (d == 0 || k == 0) return;
  const std::size_t n = vectors.size() / d;
  TRIVET_REQUIRE(vectors.size() * k == out.size() * d, "one projection a vector");
  alignas(64) std::array<std::int16_t, kVectorsInCache * kMostNumbers> some;
  std::array<float, kMostNumbers> less;
  std::array<float, kVectorsInCache> units;
  std::array<std::int32_t, kVectors * kComponents> products;
  for (std::size_t first = 0; first < n; first += kVectorsInCache) {
    const std::size_t count = std::min(kVectorsInCache, n - first);
    std::fill_n(some.begin(), filled_up(count, kVectors) * stride_, std::int16_t{0});
    for (std::size_t i = 0; i < count; ++i)
      units[i] = write_rounded(vectors.data() + (first + i) * d, mean_.data(), d, less.data(),
                               some.data() + i * stride_);
    for (std::size_t c = 0; c < k; c += kComponents) {
      for (std::size_t i = 0; i < count; i += kVectors) {
        multiply(some.data() + i * stride_, components_.data() + c * stride_, stride_, products);
        for (std::size_t v = 0; v < kVectors && i + v < count; ++v) {
          for (std::size_t j = 0; j < kComponents && c + j < k; ++j)
            out[(first + i + v) * k + c + j] =
                units[i + v] * static_cast<float>(products[v * kComponents + j]);
        }
      }
    }
  }
}

}  // namespace trivet::kernels

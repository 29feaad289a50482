#include "kernels/spin_images/code_index.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>

#include "kernels/spin_images/byte_products.hpp"
#include "storage/common/simd.hpp"

namespace trivet::kernels {
namespace {

constexpr std::size_t kBlock = 16;

/// Byte by byte, in a loop that the compiler unrolls for a known stride.
template <std::size_t Stride>
[[gnu::always_inline]] inline void distances(const std::uint8_t* __restrict code,
                                             const std::uint8_t* __restrict others,
                                             std::size_t stride, std::size_t n,
                                             std::uint32_t* __restrict squared) noexcept {
  const std::size_t bytes = Stride > 0 ? Stride : stride;
  for (std::size_t i = 0; i < n; ++i) {
    std::int32_t sum = 0;
    for (std::size_t j = 0; j < bytes; ++j) {
      const auto d = static_cast<std::int16_t>(code[j] - others[i * bytes + j]);
      sum += static_cast<std::int32_t>(d) * static_cast<std::int32_t>(d);
    }
    squared[i] = static_cast<std::uint32_t>(sum);
  }
}

TRIVET_SIMD_CLONES
void find_distances(const std::uint8_t* __restrict code, const std::uint8_t* __restrict others,
                    std::size_t stride, std::size_t n, std::uint32_t* __restrict squared) noexcept {
  if (stride == kUsualStride) {
    distances<kUsualStride>(code, others, stride, n, squared);
  } else {
    distances<0>(code, others, stride, n, squared);
  }
}

TRIVET_SIMD_CLONES
void find_norms(const std::uint8_t* __restrict codes, std::size_t stride, std::size_t n,
                std::int32_t* __restrict norms) noexcept {
  for (std::size_t i = 0; i < n; ++i) {
    std::int32_t sum = 0;
    for (std::size_t j = 0; j < stride; ++j) {
      const std::int32_t c = codes[i * stride + j];
      sum += c * (c - 256);
    }
    norms[i] = sum;
  }
}

#if defined(__x86_64__)

#pragma GCC diagnostic push  // GCC 12 warns about its own intrinsics
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"

/// Partial sums of two vectors, interleaved: a b a b in every four numbers.
TRIVET_BYTE_PRODUCTS inline __m512i add_halves(__m512i a, __m512i b) noexcept {
  return _mm512_add_epi32(_mm512_unpacklo_epi32(a, b), _mm512_unpackhi_epi32(a, b));
}

/// Sums of the first two quarters of each vector, and of the last two.
TRIVET_BYTE_PRODUCTS inline __m512i add_quarters(__m512i a, __m512i b) noexcept {
  return _mm512_add_epi32(_mm512_shuffle_i32x4(a, b, 0x88), _mm512_shuffle_i32x4(a, b, 0xdd));
}

/// The sums of the numbers of each of 16 vectors.
TRIVET_BYTE_PRODUCTS inline __m512i sums_of(const __m512i* v) noexcept {
  __m512i fours[4];  // a b c d in every four numbers
  for (int k = 0; k < 4; ++k) {
    const __m512i ab = add_halves(v[4 * k], v[4 * k + 1]);
    const __m512i cd = add_halves(v[4 * k + 2], v[4 * k + 3]);
    fours[k] = _mm512_add_epi32(_mm512_unpacklo_epi64(ab, cd), _mm512_unpackhi_epi64(ab, cd));
  }
  return add_quarters(add_quarters(fours[0], fours[1]), add_quarters(fours[2], fours[3]));
}

/// Processes sixteen codes at a time, with one instruction for the product of each with the query.
TRIVET_BYTE_PRODUCTS void distances_by_products(const std::uint8_t* __restrict code,
                                                const std::uint8_t* __restrict others,
                                                const std::int32_t* __restrict norms, std::size_t n,
                                                std::uint32_t* __restrict squared) noexcept {
  const __m512i sign = _mm512_set1_epi8(static_cast<char>(0x80));
  const __m512i query = _mm512_xor_si512(_mm512_loadu_si512(code), sign);  // q - 128, signed
  std::int32_t own = 0;                                                    // |q|^2
  for (std::size_t j = 0; j < kUsualStride; ++j) own += code[j] * code[j];
  const __m512i square = _mm512_set1_epi32(own);
  for (std::size_t i = 0; i + kBlock <= n; i += kBlock) {
    __m512i products[kBlock];
    for (std::size_t k = 0; k < kBlock; ++k) {
      products[k] = _mm512_dpbusd_epi32(_mm512_setzero_si512(),
                                        _mm512_loadu_si512(others + (i + k) * kUsualStride), query);
    }
    const __m512i twice = _mm512_slli_epi32(sums_of(products), 1);
    const __m512i distance =
        _mm512_sub_epi32(_mm512_add_epi32(_mm512_loadu_si512(norms + i), square), twice);
    _mm512_storeu_si512(squared + i, distance);
  }
}

#pragma GCC diagnostic pop
#endif

void insert(const CodeNeighbor& neighbor, CodeNeighbor* nearest, std::size_t k) noexcept {
  if (!(neighbor < nearest[k - 1])) return;
  std::size_t at = k - 1;
  for (; at > 0 && neighbor < nearest[at - 1]; --at) nearest[at] = nearest[at - 1];
  nearest[at] = neighbor;
}

/// Most codes are too far: whole blocks of them are skipped.
TRIVET_SIMD_CLONES
void keep(const std::uint32_t* __restrict squared, std::size_t n, std::uint32_t first,
          CodeNeighbor* nearest, std::size_t k) noexcept {
  std::size_t i = 0;
  for (; i + kBlock <= n; i += kBlock) {
    std::uint32_t least = squared[i];
    for (std::size_t j = 1; j < kBlock; ++j) least = std::min(least, squared[i + j]);
    if (least > nearest[k - 1].squared) continue;
    for (std::size_t j = i; j < i + kBlock; ++j)
      insert({squared[j], first + static_cast<std::uint32_t>(j)}, nearest, k);
  }
  for (; i < n; ++i) insert({squared[i], first + static_cast<std::uint32_t>(i)}, nearest, k);
}

}  // namespace

void pad_codes(std::span<const std::uint8_t> codes, std::size_t dimension,
               std::span<std::uint8_t> padded) noexcept {
  const std::size_t stride = code_stride(dimension), n = codes.size() / dimension;
  assert(padded.size() == n * stride);
  std::ranges::fill(padded, std::uint8_t{0});
  for (std::size_t i = 0; i < n; ++i)
    std::memcpy(padded.data() + i * stride, codes.data() + i * dimension, dimension);
}

void code_norms(std::span<const std::uint8_t> codes, std::size_t stride,
                std::span<std::int32_t> norms) noexcept {
  assert(codes.size() == norms.size() * stride);
  find_norms(codes.data(), stride, norms.size(), norms.data());
}

void code_distances(std::span<const std::uint8_t> code, std::span<const std::uint8_t> others,
                    std::span<const std::int32_t> norms,
                    std::span<std::uint32_t> squared) noexcept {
  assert(others.size() == squared.size() * code.size() && norms.size() == squared.size());
  std::size_t done = 0;
#if defined(__x86_64__)
  if (code.size() == kUsualStride && has_byte_products()) {
    done = squared.size() / kBlock * kBlock;
    distances_by_products(code.data(), others.data(), norms.data(), done, squared.data());
  }
#endif
  find_distances(code.data(), others.data() + done * code.size(), code.size(),
                 squared.size() - done, squared.data() + done);
}

void keep_nearest(std::span<const std::uint32_t> squared, std::uint32_t first,
                  std::span<CodeNeighbor> nearest) noexcept {
  keep(squared.data(), squared.size(), first, nearest.data(), nearest.size());
}

void nearest_lists(const CodeIndexView& index, std::span<const std::uint8_t> query,
                   std::span<const std::int32_t> norms, std::span<std::uint32_t> distances,
                   std::span<CodeNeighbor> lists) noexcept {
  code_distances(query, index.centroids, norms, distances);
  std::ranges::fill(lists, CodeNeighbor{});
  keep_nearest(distances, 0, lists);
}

}  // namespace trivet::kernels

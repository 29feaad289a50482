#include "kernels/spin_images/nearest_centroids.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>
#include <limits>

#include "kernels/spin_images/byte_products.hpp"
#include "kernels/spin_images/code_index.hpp"

namespace trivet::kernels {
namespace {

constexpr std::size_t kCodes = 64;          // codes compared with a centroid at a time
constexpr std::size_t kFewCentroids = 256;  // centroids that stay in the first-level cache with
                                            // their distances

/// One code after the other, for any processor.
void nearest_one_by_one(std::span<const std::uint8_t> codes, std::size_t stride,
                        std::span<const std::uint8_t> centroids,
                        std::span<const std::int32_t> norms,
                        std::span<std::uint32_t> nearest) noexcept {
  std::array<std::uint32_t, kFewCentroids> distances;
  std::array<std::uint32_t, kCodes> least;
  least.fill(std::numeric_limits<std::uint32_t>::max());
  for (std::size_t first = 0; first < norms.size(); first += kFewCentroids) {
    const std::size_t count = std::min(kFewCentroids, norms.size() - first);
    const auto some = std::span(distances).first(count);
    for (std::size_t i = 0; i < nearest.size(); ++i) {
      code_distances(codes.subspan(i * stride, stride),
                     centroids.subspan(first * stride, count * stride), norms.subspan(first, count),
                     some);
      const auto at = std::ranges::min_element(some);
      if (*at >= least[i]) continue;
      least[i] = *at;
      nearest[i] = static_cast<std::uint32_t>(first + static_cast<std::size_t>(at - some.begin()));
    }
  }
}

#if defined(__x86_64__)

constexpr std::size_t kLanes = 16;                 // numbers in a vector
constexpr std::size_t kQuads = kUsualStride / 4;   // four bytes of a code make one number
constexpr std::size_t kVectors = kCodes / kLanes;  // vectors for one quad of each code
constexpr std::size_t kTile = 6;                   // centroids per tile: 24 sums stay in registers

/// The bytes of 64 codes minus 128, quad by quad: a vector has one quad of sixteen codes.
struct alignas(64) Quads {
  std::array<std::array<std::uint32_t, kCodes>, kQuads> of;
};

void fill(Quads& quads, std::span<const std::uint8_t> codes) noexcept {
  const std::size_t n = codes.size() / kUsualStride;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < kQuads; ++k) {
      std::uint32_t quad = 0;
      std::memcpy(&quad, codes.data() + i * kUsualStride + 4 * k, sizeof(quad));
      quads.of[k][i] = quad ^ 0x80808080U;
    }
  }
}

#pragma GCC diagnostic push  // GCC 12 warns about its own intrinsics
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"

/// For each of 64 codes the nearest centroid so far, and its distance minus the code's own square.
struct Nearest {
  __m512i distance[kVectors], index[kVectors];
};

/// Compare all 64 codes with some centroids, as in matrix multiplication: loaded values are used
/// for all pairs of a tile.
template <std::size_t Tile>
[[gnu::always_inline]] TRIVET_BYTE_PRODUCTS inline void compare(const Quads& quads,
                                                                const std::uint8_t* centroids,
                                                                const std::int32_t* norms,
                                                                std::size_t first,
                                                                Nearest& nearest) noexcept {
  __m512i products[Tile][kVectors];
#pragma GCC unroll 8
  for (std::size_t t = 0; t < Tile; ++t) {
#pragma GCC unroll 8
    for (std::size_t v = 0; v < kVectors; ++v) products[t][v] = _mm512_setzero_si512();
  }
  for (std::size_t k = 0; k < kQuads; ++k) {
    __m512i code[kVectors];
#pragma GCC unroll 8
    for (std::size_t v = 0; v < kVectors; ++v)
      code[v] = _mm512_load_si512(quads.of[k].data() + v * kLanes);
#pragma GCC unroll 8
    for (std::size_t t = 0; t < Tile; ++t) {
      std::int32_t quad = 0;
      std::memcpy(&quad, centroids + (first + t) * kUsualStride + 4 * k, sizeof(quad));
      const __m512i centroid = _mm512_set1_epi32(quad);
#pragma GCC unroll 8
      for (std::size_t v = 0; v < kVectors; ++v)
        products[t][v] = _mm512_dpbusd_epi32(products[t][v], centroid, code[v]);
    }
  }
#pragma GCC unroll 8
  for (std::size_t t = 0; t < Tile; ++t) {
    const __m512i norm = _mm512_set1_epi32(norms[first + t]);
    const __m512i index = _mm512_set1_epi32(static_cast<std::int32_t>(first + t));
#pragma GCC unroll 8
    for (std::size_t v = 0; v < kVectors; ++v) {
      const __m512i distance = _mm512_sub_epi32(norm, _mm512_slli_epi32(products[t][v], 1));
      const __mmask16 is_nearer = _mm512_cmplt_epi32_mask(distance, nearest.distance[v]);
      nearest.distance[v] = _mm512_min_epi32(distance, nearest.distance[v]);
      nearest.index[v] = _mm512_mask_mov_epi32(nearest.index[v], is_nearer, index);
    }
  }
}

/// Process a block of at most 64 codes.
TRIVET_BYTE_PRODUCTS void nearest_by_products(std::span<const std::uint8_t> codes,
                                              std::span<const std::uint8_t> centroids,
                                              std::span<const std::int32_t> norms,
                                              std::span<std::uint32_t> nearest) noexcept {
  Quads quads{};
  fill(quads, codes);
  Nearest best;
  for (std::size_t v = 0; v < kVectors; ++v) {
    best.distance[v] = _mm512_set1_epi32(std::numeric_limits<std::int32_t>::max());
    best.index[v] = _mm512_setzero_si512();
  }
  std::size_t first = 0;
  for (; first + kTile <= norms.size(); first += kTile)
    compare<kTile>(quads, centroids.data(), norms.data(), first, best);
  for (; first < norms.size(); ++first)
    compare<1>(quads, centroids.data(), norms.data(), first, best);
  alignas(64) std::array<std::uint32_t, kCodes> index;
  for (std::size_t v = 0; v < kVectors; ++v)
    _mm512_store_si512(index.data() + v * kLanes, best.index[v]);
  std::ranges::copy(std::span(index).first(nearest.size()), nearest.begin());
}

#pragma GCC diagnostic pop
#endif

void nearest_of_block(std::span<const std::uint8_t> codes, std::size_t stride,
                      std::span<const std::uint8_t> centroids, std::span<const std::int32_t> norms,
                      std::span<std::uint32_t> nearest) noexcept {
#if defined(__x86_64__)
  if (stride == kUsualStride && has_byte_products()) {
    nearest_by_products(codes, centroids, norms, nearest);
    return;
  }
#endif
  nearest_one_by_one(codes, stride, centroids, norms, nearest);
}

}  // namespace

void nearest_centroids(std::span<const std::uint8_t> codes, std::size_t stride,
                       std::span<const std::uint8_t> centroids, std::span<const std::int32_t> norms,
                       std::span<std::uint32_t> nearest) noexcept {
  assert(codes.size() == nearest.size() * stride && centroids.size() == norms.size() * stride);
  for (std::size_t first = 0; first < nearest.size(); first += kCodes) {
    const std::size_t count = std::min(kCodes, nearest.size() - first);
    nearest_of_block(codes.subspan(first * stride, count * stride), stride, centroids, norms,
                     nearest.subspan(first, count));
  }
}

void add_to_centroids(std::span<const std::uint8_t> codes, std::size_t stride,
                      std::span<const std::uint32_t> nearest, CentroidSums& sums) noexcept {
  assert(codes.size() == nearest.size() * stride);
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    ++sums.counts[nearest[i]];
    std::uint64_t* const sum = sums.sums.data() + nearest[i] * stride;
    for (std::size_t j = 0; j < stride; ++j) sum[j] += codes[i * stride + j];
  }
}

void move_centroids(const CentroidSums& sums, std::span<std::uint8_t> centroids) noexcept {
  const std::size_t stride = centroids.size() / sums.counts.size();
  for (std::size_t l = 0; l < sums.counts.size(); ++l) {
    const std::uint64_t count = sums.counts[l];
    if (count == 0) continue;
    for (std::size_t j = l * stride; j < (l + 1) * stride; ++j)
      centroids[j] = static_cast<std::uint8_t>((sums.sums[j] + count / 2) / count);
  }
}

}  // namespace trivet::kernels

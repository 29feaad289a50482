#include "kernels/spin_images/code_index.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>

#include "storage/simd.hpp"

namespace trivet::kernels {
namespace {

constexpr std::size_t kUsualStride = 64;  // of 60 components: a loop that the compiler unrolls
constexpr std::size_t kBlock = 16;

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

void insert(const CodeNeighbor& neighbor, CodeNeighbor* nearest, std::size_t k) noexcept {
  if (!(neighbor < nearest[k - 1])) return;
  std::size_t at = k - 1;
  for (; at > 0 && neighbor < nearest[at - 1]; --at) nearest[at] = nearest[at - 1];
  nearest[at] = neighbor;
}

/// Most codes are too far: a block of them is passed over at once.
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

void code_distances(std::span<const std::uint8_t> code, std::span<const std::uint8_t> others,
                    std::span<std::uint32_t> squared) noexcept {
  assert(others.size() == squared.size() * code.size());
  find_distances(code.data(), others.data(), code.size(), squared.size(), squared.data());
}

void keep_nearest(std::span<const std::uint32_t> squared, std::uint32_t first,
                  std::span<CodeNeighbor> nearest) noexcept {
  keep(squared.data(), squared.size(), first, nearest.data(), nearest.size());
}

void nearest_lists(const CodeIndexView& index, std::span<const std::uint8_t> query,
                   std::span<std::uint32_t> distances, std::span<CodeNeighbor> lists) noexcept {
  code_distances(query, index.centroids, distances);
  std::ranges::fill(lists, CodeNeighbor{});
  keep_nearest(distances, 0, lists);
}

std::uint32_t nearest_centroid(std::span<const std::uint8_t> code,
                               std::span<const std::uint8_t> centroids,
                               std::span<std::uint32_t> distances) noexcept {
  code_distances(code, centroids, distances);
  return static_cast<std::uint32_t>(std::ranges::min_element(distances) - distances.begin());
}

void add_to_centroids(std::span<const std::uint8_t> codes, std::size_t stride,
                      std::span<const std::uint8_t> centroids, std::span<std::uint32_t> distances,
                      CentroidSums& sums) noexcept {
  for (std::size_t first = 0; first + stride <= codes.size(); first += stride) {
    const std::span code = codes.subspan(first, stride);
    const std::size_t nearest = nearest_centroid(code, centroids, distances);
    ++sums.counts[nearest];
    for (std::size_t j = 0; j < stride; ++j) sums.sums[nearest * stride + j] += code[j];
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

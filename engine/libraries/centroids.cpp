#include "engine/libraries/centroids.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include "engine/common/by_group.hpp"
#include "engine/common/parallel.hpp"
#include "kernels/spin_images/code_index.hpp"
#include "kernels/spin_images/nearest_centroids.hpp"

namespace trivet::engine {
namespace {

constexpr std::size_t kSamples = 64;  // training codes per centroid
constexpr std::size_t kIterations = 4;
constexpr std::size_t kBlock = 4096;  // codes read at a time
// Limit up to which all centroids are compared with a code.
constexpr std::size_t kFewCentroids = 2048;
// Centers, as a multiple of the square root of the number of centroids.
constexpr std::size_t kCenters = 4;
constexpr std::size_t kAbout = 12;  // centroids around each center, as a multiple of the same root
constexpr std::size_t kCodesOfACenter = 256;  // codes of a center compared at a time

/// Subsample `count` codes evenly: the k-th is number k size / count.
Column<std::uint8_t> spread(const CodeSource& codes, std::size_t count) {
  const std::size_t stride = codes.stride;
  Column<std::uint8_t> some(count * stride);
  for_blocks(codes, kBlock, [&](std::size_t first, std::span<const std::uint8_t> block) {
    const std::size_t end = first + block.size() / stride;
    for (std::size_t k = (first * count + codes.size - 1) / codes.size; k < count; ++k) {
      const std::size_t i = k * codes.size / count;
      if (i >= end) break;
      std::ranges::copy(block.subspan((i - first) * stride, stride),
                        some.begin() + static_cast<std::ptrdiff_t>(k * stride));
    }
  });
  return some;
}

void append(std::span<const std::uint8_t> code, Column<std::uint8_t>& codes) {
  codes.insert(codes.end(), code.begin(), code.end());
}

}  // namespace

Column<std::uint8_t> find_centroids(const CodeSource& codes, std::size_t num_centroids) {
  const std::size_t stride = codes.stride;
  const std::size_t num_samples = std::min(codes.size, num_centroids * kSamples);
  const Column<std::uint8_t> samples = spread(codes, num_samples);
  Column<std::uint8_t> centroids = spread(source_of(samples, stride), num_centroids);
  for (std::size_t iteration = 0; iteration < kIterations; ++iteration) {
    PerThread<kernels::CentroidSums> per_thread(
        [&] { return kernels::CentroidSums(num_centroids, stride); });
    PerThread<std::vector<std::uint32_t>> nearest;
    const CentroidFinder finder(centroids, stride);
    for_chunks(num_samples, finder.at_once(), [&](std::size_t first, std::size_t count) {
      const auto some = std::span(samples).subspan(first * stride, count * stride);
      std::vector<std::uint32_t>& own = nearest.local();
      own.resize(count);
      finder.find(some, own);
      kernels::add_to_centroids(some, stride, own, per_thread.local());
    });
    kernels::CentroidSums sums(num_centroids, stride);
    for (const kernels::CentroidSums& some : per_thread) {
      std::ranges::transform(sums.sums, some.sums, sums.sums.begin(), std::plus());
      std::ranges::transform(sums.counts, some.counts, sums.counts.begin(), std::plus());
    }
    kernels::move_centroids(sums, centroids);
  }
  return centroids;
}

ComparedCodes::ComparedCodes(Column<std::uint8_t> codes, std::size_t stride)
    : stride_(stride), codes_(std::move(codes)), norms_(codes_.size() / stride) {
  kernels::code_norms(codes_, stride, norms_);
}

void ComparedCodes::find_nearest(std::span<const std::uint8_t> others,
                                 std::span<std::uint32_t> nearest) const {
  kernels::nearest_centroids(others, stride_, codes_, norms_, nearest);
}

void ComparedCodes::distances(std::span<const std::uint8_t> code,
                              std::span<std::uint32_t> squared) const {
  kernels::code_distances(code, codes_, norms_, squared);
}

CentroidFinder::CentroidFinder(Column<std::uint8_t> centroids, std::size_t stride)
    : stride_(stride), centers_(std::move(centroids), stride) {
  if (centers_.size() <= kFewCentroids) return;
  const ComparedCodes all = std::exchange(centers_, {});
  const auto root = static_cast<std::size_t>(std::sqrt(static_cast<double>(all.size())));
  centers_ = ComparedCodes(find_centroids(source_of(all.codes(), stride), kCenters * root), stride);
  surroundings_.resize(centers_.size());
  for_each_index(centers_.size(), [&](std::size_t c) {
    surroundings_[c] = surroundings_of(centers_[c], kAbout * root, all);
  });
}

CentroidFinder::Surroundings CentroidFinder::surroundings_of(std::span<const std::uint8_t> center,
                                                             std::size_t count,
                                                             const ComparedCodes& centroids) {
  std::vector<std::uint32_t> squared(centroids.size()), nearest(centroids.size());
  centroids.distances(center, squared);
  std::iota(nearest.begin(), nearest.end(), 0U);
  std::ranges::nth_element(nearest, nearest.begin() + static_cast<std::ptrdiff_t>(count), {},
                           [&](std::uint32_t i) { return std::pair(squared[i], i); });
  nearest.resize(count);
  std::ranges::sort(nearest);
  Column<std::uint8_t> codes;
  for (const std::uint32_t i : nearest) append(centroids[i], codes);
  return {std::move(nearest), ComparedCodes(std::move(codes), centroids.stride())};
}

std::size_t CentroidFinder::at_once() const noexcept {
  return std::max(kBlock, surroundings_.size() * kCodesOfACenter);
}

void CentroidFinder::find(std::span<const std::uint8_t> codes,
                          std::span<std::uint32_t> nearest) const {
  centers_.find_nearest(codes, nearest);
  if (surroundings_.empty()) return;
  const ByGroup codes_of = by_group(nearest, centers_.size());
  Column<std::uint8_t> some;
  std::vector<std::uint32_t> own;
  for (std::size_t c = 0; c < surroundings_.size(); ++c) {
    const auto which = codes_of.of(c);
    some.clear();
    for (const std::uint32_t i : which) append(codes.subspan(i * stride_, stride_), some);
    own.resize(which.size());
    surroundings_[c].centroids.find_nearest(some, own);
    for (std::size_t k = 0; k < which.size(); ++k)
      nearest[which[k]] = surroundings_[c].which[own[k]];
  }
}

}  // namespace trivet::engine

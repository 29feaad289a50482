#include "engine/libraries/build_code_lists.hpp"

#include <algorithm>
#include <functional>

#include "engine/common/parallel.hpp"
#include "kernels/spin_images/code_index.hpp"
#include "kernels/spin_images/nearest_centroids.hpp"

namespace trivet::engine {
namespace {

constexpr std::size_t kListLength = 2000;  // codes a list, on the average
constexpr std::size_t kSamplesAList = 64;  // codes that centroids are found from
constexpr std::size_t kIterations = 4;
constexpr std::size_t kGrain = 1024;

/// Centroids of codes, from such spread over them.
Column<std::uint8_t> find_centroids(std::span<const std::uint8_t> codes, std::size_t stride,
                                    std::size_t num_lists) {
  const std::size_t n = codes.size() / stride;
  const auto spread = [&](std::size_t count) {
    Column<std::uint8_t> some(count * stride);
    for (std::size_t k = 0; k < count; ++k)
      std::ranges::copy(codes.subspan(k * n / count * stride, stride),
                        some.begin() + static_cast<std::ptrdiff_t>(k * stride));
    return some;
  };
  Column<std::uint8_t> centroids = spread(num_lists);
  const Column<std::uint8_t> samples = spread(std::min(n, num_lists * kSamplesAList));
  const std::size_t num_samples = samples.size() / stride;
  Column<std::int32_t> norms(num_lists);
  for (std::size_t iteration = 0; iteration < kIterations; ++iteration) {
    PerThread<kernels::CentroidSums> per_thread(
        [&] { return kernels::CentroidSums(num_lists, stride); });
    PerThread<std::vector<std::uint32_t>> nearest;
    kernels::code_norms(centroids, stride, norms);
    for_chunks(num_samples, kGrain, [&](std::size_t first, std::size_t count) {
      const auto some = std::span(samples).subspan(first * stride, count * stride);
      std::vector<std::uint32_t>& own = nearest.local();
      own.resize(count);
      kernels::nearest_centroids(some, stride, centroids, norms, own);
      kernels::add_to_centroids(some, stride, own, per_thread.local());
    });
    kernels::CentroidSums sums(num_lists, stride);
    for (const kernels::CentroidSums& some : per_thread) {
      std::ranges::transform(sums.sums, some.sums, sums.sums.begin(), std::plus());
      std::ranges::transform(sums.counts, some.counts, sums.counts.begin(), std::plus());
    }
    kernels::move_centroids(sums, centroids);
  }
  return centroids;
}

}  // namespace

CodeLists build_code_lists(std::span<const std::uint8_t> codes, std::size_t stride) {
  const std::size_t n = codes.size() / stride;
  CodeLists lists;
  const std::size_t num_lists = std::max<std::size_t>(1, n / kListLength);
  lists.centroids = find_centroids(codes, stride, num_lists);
  std::vector<std::uint32_t> list(n);
  Column<std::int32_t> norms(num_lists);
  kernels::code_norms(lists.centroids, stride, norms);
  for_chunks(n, kGrain, [&](std::size_t first, std::size_t count) {
    kernels::nearest_centroids(codes.subspan(first * stride, count * stride), stride,
                               lists.centroids, norms, std::span(list).subspan(first, count));
  });
  lists.offsets.assign(num_lists + 1, 0);
  for (const std::uint32_t l : list) ++lists.offsets[l];
  (void)counts_to_offsets(lists.offsets);
  lists.order.resize(n);
  std::vector<std::uint32_t> next(lists.offsets.begin(), lists.offsets.end() - 1);
  for (std::uint32_t i = 0; i < n; ++i) lists.order[next[list[i]]++] = i;
  return lists;
}

}  // namespace trivet::engine

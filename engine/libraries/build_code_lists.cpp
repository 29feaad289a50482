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
constexpr std::size_t kBlock = 4096;  // codes that are read at a time

/// Call body(first, codes) for blocks that cover all codes.
template <class Body>
void for_blocks(const CodeSource& codes, Body&& body) {
  PerThread<Column<std::uint8_t>> blocks(
      [&] { return Column<std::uint8_t>(std::min(kBlock, codes.size) * codes.stride); });
  for_each_index((codes.size + kBlock - 1) / kBlock, [&](std::size_t b) {
    const std::size_t first = b * kBlock, count = std::min(kBlock, codes.size - first);
    const auto block = std::span(blocks.local()).first(count * codes.stride);
    codes.read(first, block);
    body(first, std::span<const std::uint8_t>(block));
  });
}

/// So many codes spread over all: the k-th is number k size / count.
Column<std::uint8_t> spread(const CodeSource& codes, std::size_t count) {
  const std::size_t stride = codes.stride;
  Column<std::uint8_t> some(count * stride);
  for_blocks(codes, [&](std::size_t first, std::span<const std::uint8_t> block) {
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

Column<std::uint8_t> find_centroids(const CodeSource& codes, std::size_t num_lists) {
  const std::size_t stride = codes.stride;
  const std::size_t num_samples = std::min(codes.size, num_lists * kSamplesAList);
  const Column<std::uint8_t> samples = spread(codes, num_samples);
  Column<std::uint8_t> centroids = spread(
      {num_samples, stride,
       [&](std::size_t first, std::span<std::uint8_t> some) {
         std::ranges::copy(std::span(samples).subspan(first * stride, some.size()), some.begin());
       }},
      num_lists);
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

CodeLists build_code_lists(const CodeSource& codes) {
  CodeLists lists;
  const std::size_t num_lists = std::max<std::size_t>(1, codes.size / kListLength);
  lists.centroids = find_centroids(codes, num_lists);
  lists.list.resize(codes.size);
  Column<std::int32_t> norms(num_lists);
  kernels::code_norms(lists.centroids, codes.stride, norms);
  for_blocks(codes, [&](std::size_t first, std::span<const std::uint8_t> block) {
    kernels::nearest_centroids(block, codes.stride, lists.centroids, norms,
                               std::span(lists.list).subspan(first, block.size() / codes.stride));
  });
  lists.offsets.assign(num_lists + 1, 0);
  for (const std::uint32_t l : lists.list) ++lists.offsets[l];
  (void)counts_to_offsets(lists.offsets);
  return lists;
}

CodeLists build_code_lists(std::span<const std::uint8_t> codes, std::size_t stride) {
  return build_code_lists(
      {codes.size() / stride, stride, [&](std::size_t first, std::span<std::uint8_t> some) {
         std::ranges::copy(codes.subspan(first * stride, some.size()), some.begin());
       }});
}

}  // namespace trivet::engine

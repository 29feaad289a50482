#include "engine/hypotheses/search_codes.hpp"

#include <algorithm>

#include "engine/common/by_group.hpp"
#include "engine/common/parallel.hpp"
#include "storage/common/precondition.hpp"

namespace trivet::engine {
namespace {

constexpr std::size_t kQueryGrain = 64;
constexpr std::size_t kTile = 1024;  // codes compared with a query at a time
// Bytes of codes between two calls of after_part.
constexpr std::size_t kPartBytes = std::size_t{64} << 20U;

}  // namespace

CodeNeighbors search_codes(const kernels::CodeIndexView& index,
                           std::span<const std::uint8_t> queries, std::size_t probes,
                           std::size_t num_neighbors, const std::function<void()>& after_part) {
  using kernels::CodeNeighbor;
  TRIVET_REQUIRE(index.size() > 0, "an index that holds codes");
  const std::size_t stride = index.stride, n = queries.size() / stride;
  const std::size_t num_lists = index.num_lists(), visited = std::min(probes, num_lists);
  const auto query = [&](std::size_t q) { return queries.subspan(q * stride, stride); };

  PerThread<Column<std::uint32_t>> scratch(
      [&] { return Column<std::uint32_t>(std::max(num_lists, kTile)); });
  PerThread<std::vector<CodeNeighbor>> nearest([&] { return std::vector<CodeNeighbor>(visited); });
  Column<std::int32_t> list_norms(num_lists);
  kernels::code_norms(index.centroids, stride, list_norms);
  std::vector<std::uint32_t> lists(n * visited);
  for_chunks(n, kQueryGrain, [&](std::size_t first, std::size_t count) {
    std::vector<CodeNeighbor>& best = nearest.local();
    for (std::size_t q = first; q < first + count; ++q) {
      kernels::nearest_lists(index, query(q), list_norms,
                             std::span(scratch.local()).first(num_lists), best);
      for (std::size_t p = 0; p < visited; ++p) lists[q * visited + p] = best[p].index;
    }
  });

  PerThread<Column<std::int32_t>> tile_norms([] { return Column<std::int32_t>(kTile); });
  // Values query * probes + probe, grouped by list.
  const ByGroup visits = by_group(lists, num_lists);
  std::vector<CodeNeighbor> of_visit(lists.size() * num_neighbors);
  const auto compare_list = [&](std::size_t l) {
    if (visits.of(l).empty()) return;
    // The offsets may lie in a mapped file that is modified concurrently.
    const std::size_t end =
        std::min<std::size_t>(index.offsets[l + 1], index.codes.size() / stride);
    for (std::size_t first = index.offsets[l]; first < end; first += kTile) {
      check_stop();
      const std::size_t count = std::min(kTile, end - first);
      const auto codes = index.codes.subspan(first * stride, count * stride);
      const std::span squared = std::span(scratch.local()).first(count);
      const std::span norms = std::span(tile_norms.local()).first(count);
      kernels::code_norms(codes, stride, norms);
      for (const std::size_t slot : visits.of(l)) {
        kernels::code_distances(query(slot / visited), codes, norms, squared);
        kernels::keep_nearest(squared, static_cast<std::uint32_t>(first),
                              std::span(of_visit).subspan(slot * num_neighbors, num_neighbors));
      }
    }
  };
  for (std::size_t first = 0, last = 0; first < num_lists; first = last) {
    const std::size_t end = index.offsets[first] + kPartBytes / stride;
    last = first + 1;
    while (last < num_lists && index.offsets[last + 1] <= end) ++last;
    for_each_index(last - first, [&](std::size_t k) { compare_list(first + k); });
    if (after_part) after_part();
  }

  CodeNeighbors found{num_neighbors, std::vector<CodeNeighbor>(n * num_neighbors)};
  for_chunks(n, kQueryGrain, [&](std::size_t first, std::size_t count) {
    for (std::size_t q = first; q < first + count; ++q) {
      std::ranges::partial_sort_copy(
          std::span(of_visit).subspan(q * visited * num_neighbors, visited * num_neighbors),
          std::span(found.all).subspan(q * num_neighbors, num_neighbors));
    }
  });
  return found;
}

}  // namespace trivet::engine

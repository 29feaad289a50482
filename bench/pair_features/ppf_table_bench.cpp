// Point pair feature tables of the same points: all ordered pairs, one thread.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <unordered_map>

#include "kernels/pair_features/ppf_table.hpp"
#include "parts.hpp"
#include "support/reference_ppf.hpp"

namespace trivet::bench {
namespace {

constexpr std::int64_t kSizes[] = {256, 1024, 4096};
constexpr std::int64_t kNaiveSizes[] = {256, 1024};

/// The first points of the bracket's surface, and the quantization of their pairs.
struct TableInput {
  PointsView points;
  NormalsView normals;
  PpfQuantization quantization;
};

TableInput table_input(std::int64_t num_points) {
  const OrientedPoints& surface = part_surface(parts()[0]);
  const std::size_t n = std::min(surface.points.size(), static_cast<std::size_t>(num_points));
  return {surface.points.view().slice(0, n),
          surface.normals.view().slice(0, n),
          {0.04F * 0.2F, 25, 15}};
}

struct Table {
  Column<std::uint32_t> offsets;
  Column<PpfEntry> entries;
};

Table build(const TableInput& input) {
  const kernels::PpfPoints model{input.points, input.normals, {}};
  const std::size_t n = input.points.size(), num_cells = input.quantization.num_cells();
  kernels::PairScratch scratch(n);
  Column<std::uint32_t> counts(num_cells, 0);
  Table table;
  table.offsets.resize(num_cells + 1);
  kernels::count_ppf_pairs({model, input.quantization, 0, n}, scratch, counts);
  table.entries.resize(kernels::scan_ppf_counts(counts, 1, table.offsets));
  kernels::fill_ppf_entries({model, input.quantization, 0, n}, scratch, counts, table.entries);
  kernels::sort_ppf_cells(table.offsets, 0, num_cells, table.entries);
  return table;
}

struct NaiveEntry {
  std::uint32_t reference;
  double rotation;
};
using NaiveTable = std::unordered_multimap<std::uint32_t, NaiveEntry>;

NaiveTable naive_build(const TableInput& input) {
  NaiveTable table;
  for (std::uint32_t r = 0; r < input.points.size(); ++r) {
    const Pose T = kernels::frame_pose(kernels::reference_frame(input.points[r], input.normals[r]));
    for (std::uint32_t i = 0; i < input.points.size(); ++i) {
      if (i == r) continue;
      const auto feature = reference::pair_feature(input.points[r], input.normals[r],
                                                   input.points[i], input.normals[i], T);
      if (const auto cell = reference::cell_of(feature, input.quantization)) {
        table.insert({*cell, {r, feature.rotation}});
      }
    }
  }
  return table;
}

// The fraction of the naive table's pairs that are in another cell; float and double may round a
// pair on a bin's border to different sides.
double misplaced(const Table& table, const NaiveTable& naive) {
  using Place = std::pair<std::uint32_t, std::uint32_t>;
  std::vector<Place> found, expected, missing;
  for (std::uint32_t cell = 0; cell + 1 < table.offsets.size(); ++cell) {
    for (std::uint32_t e = table.offsets[cell]; e < table.offsets[cell + 1]; ++e) {
      found.emplace_back(cell, table.entries[e].reference);
    }
  }
  for (const auto& [cell, entry] : naive) expected.emplace_back(cell, entry.reference);
  std::ranges::sort(found);
  std::ranges::sort(expected);
  std::ranges::set_difference(expected, found, std::back_inserter(missing));
  return static_cast<double>(missing.size()) / static_cast<double>(expected.size());
}

void count_pairs(benchmark::State& state, std::size_t num_pairs) {
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(num_pairs));
  state.counters["pairs"] = static_cast<double>(num_pairs);
}

void ours(benchmark::State& state) {
  const TableInput input = table_input(state.range(0));
  Table table;
  for (auto _ : state) table = build(input);
  count_pairs(state, table.entries.size());
  if (state.range(0) <= std::ranges::max(kNaiveSizes)) {
    state.counters["misplaced"] = misplaced(table, naive_build(input));
  }
}
BENCHMARK(ours)
    ->Name("ppf_table/ours")
    ->ArgsProduct({{std::begin(kSizes), std::end(kSizes)}})
    ->Unit(benchmark::kMillisecond);

void naive(benchmark::State& state) {
  const TableInput input = table_input(state.range(0));
  NaiveTable table;
  for (auto _ : state) table = naive_build(input);
  count_pairs(state, table.size());
}
BENCHMARK(naive)
    ->Name("ppf_table/naive")
    ->ArgsProduct({{std::begin(kNaiveSizes), std::end(kNaiveSizes)}})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace trivet::bench

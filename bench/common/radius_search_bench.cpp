#include <numeric>

#include "kernels/common/nearest_neighbors.hpp"
#include "kernels/common/voxel_hash.hpp"
#include "rows.hpp"
#include "storage/data/neighborhoods.hpp"
#include "support/reference.hpp"

namespace trivet::bench {
namespace {

// The fraction of sampled queries whose neighbors differ from the reference's. A distance that
// float and double put on different sides of the radius counts as different.
double wrong_rows(const Scan& scan, NeighborhoodsView rows) {
  double wrong = 0;
  constexpr std::size_t kSamples = 50;
  for (std::size_t k = 0; k < kSamples; ++k) {
    const std::size_t i = k * scan.points.size() / kSamples;
    const auto row = rows.row(i);
    std::vector<std::uint32_t> found(row.begin(), row.end());
    std::ranges::sort(found);
    if (found != reference::within(scan.points, scan.points[i], search_radius(scan))) ++wrong;
  }
  return wrong / kSamples;
}

void report(benchmark::State& state, const Scan& scan, NeighborhoodsView rows) {
  state.counters["neighbors"] =
      static_cast<double>(rows.indices.size()) / static_cast<double>(rows.size());
  state.counters["wrong_rows"] = wrong_rows(scan, rows);
}

// All neighborhoods of a scan, including the construction of the search structure.
const bool kVoxelHash = add_rows("radius_search/ours_voxel_hash", [](benchmark::State& state,
                                                                     const Scan& scan) {
  const float radius = search_radius(scan);
  Neighborhoods rows;
  for (auto _ : state) {
    const kernels::VoxelHash grid(scan.points, radius);
    rows.offsets.assign(scan.points.size() + 1, 0);
    kernels::count_radius_neighbors(grid, scan.points, radius, std::span(rows.offsets).subspan(1));
    std::inclusive_scan(rows.offsets.begin(), rows.offsets.end(), rows.offsets.begin());
    rows.indices.resize(rows.offsets.back());
    kernels::fill_radius_neighbors(grid, scan.points, radius, rows.offsets, rows.indices);
  }
  report(state, scan, rows);
});

const bool kKdTree =
    add_rows("radius_search/ours_kd_tree", [](benchmark::State& state, const Scan& scan) {
      const float radius = search_radius(scan);
      std::vector<float> queries;
      for (std::size_t i = 0; i < scan.points.size(); ++i) {
        const Eigen::Vector3f p = scan.points[i];
        queries.insert(queries.end(), {p.x(), p.y(), p.z()});
      }
      Neighborhoods rows;
      for (auto _ : state) {
        const auto tree = kernels::NearestNeighbors::build(scan.points);
        rows.offsets.assign(scan.points.size() + 1, 0);
        bool done = tree.has_value() &&
                    tree->count_within(queries, radius, std::span(rows.offsets).subspan(1));
        std::inclusive_scan(rows.offsets.begin(), rows.offsets.end(), rows.offsets.begin());
        rows.indices.resize(rows.offsets.back());
        done = done && tree->fill_within(queries, radius, rows.offsets, rows.indices);
        if (!done) return state.SkipWithError("the search failed");
      }
      report(state, scan, rows);
    });

const bool kNaive =
    add_naive_row("radius_search/naive", [](benchmark::State& state, const Scan& scan) {
      Neighborhoods rows;
      for (auto _ : state) {
        rows.offsets.assign(1, 0);
        rows.indices.clear();
        for (std::size_t i = 0; i < scan.points.size(); ++i) {
          const auto row = reference::within(scan.points, scan.points[i], search_radius(scan));
          rows.indices.insert(rows.indices.end(), row.begin(), row.end());
          rows.offsets.push_back(static_cast<std::uint32_t>(rows.indices.size()));
        }
      }
      report(state, scan, rows);
    });

}  // namespace
}  // namespace trivet::bench

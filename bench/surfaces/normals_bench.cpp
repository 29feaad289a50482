#include <numeric>

#include "kernels/common/voxel_hash.hpp"
#include "kernels/scans/estimate_normals_grid.hpp"
#include "kernels/surfaces/estimate_normals.hpp"
#include "rows.hpp"
#include "storage/data/neighborhoods.hpp"
#include "support/reference.hpp"

namespace trivet::bench {
namespace {

// Each row starts from points alone and includes the neighbor search.
const bool kGrid =
    add_rows("normals/ours_pixels_w3", [](benchmark::State& state, const Scan& scan) {
      Normals normals(scan.points.size());
      kernels::PixelPoints pixels;
      for (auto _ : state) {
        kernels::arrange_pixels(scan.grid, scan.points, pixels);
        kernels::estimate_normals_grid({scan.grid, pixels, {0, 0, 0}}, {.window = 3}, 0,
                                       scan.grid.height, normals);
      }
      state.counters["angle_rmse_deg"] = angle_rmse_deg(scan, normals);
    });

const bool kRadius = add_rows("normals/ours_radius", [](benchmark::State& state, const Scan& scan) {
  const float radius = search_radius(scan);
  Normals normals(scan.points.size());
  Neighborhoods rows;
  for (auto _ : state) {
    const kernels::VoxelHash grid(scan.points, radius);
    rows.offsets.assign(scan.points.size() + 1, 0);
    kernels::count_radius_neighbors(grid, scan.points, radius, std::span(rows.offsets).subspan(1));
    std::inclusive_scan(rows.offsets.begin(), rows.offsets.end(), rows.offsets.begin());
    rows.indices.resize(rows.offsets.back());
    kernels::fill_radius_neighbors(grid, scan.points, radius, rows.offsets, rows.indices);
    kernels::estimate_normals(scan.points, rows, normals);
    kernels::orient_normals(scan.points, {0, 0, 0}, normals);
  }
  state.counters["angle_rmse_deg"] = angle_rmse_deg(scan, normals);
});

const bool kNaive =
    add_naive_row("normals/naive_radius", [](benchmark::State& state, const Scan& scan) {
      Normals normals(scan.points.size());
      for (auto _ : state) {
        for (std::size_t i = 0; i < scan.points.size(); ++i) {
          std::vector<Eigen::Vector3d> row;
          for (const std::uint32_t j :
               reference::within(scan.points, scan.points[i], search_radius(scan))) {
            row.push_back(scan.points[j].cast<double>());
          }
          const auto plane = reference::fit_plane(row);
          normals.set(i, plane ? Eigen::Vector3f(plane->normal.cast<float>())
                               : Eigen::Vector3f::Constant(std::nanf("")));
        }
      }
      state.counters["angle_rmse_deg"] = angle_rmse_deg(scan, normals);
    });

}  // namespace
}  // namespace trivet::bench

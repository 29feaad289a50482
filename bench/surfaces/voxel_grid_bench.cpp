#include "kernels/surfaces/subsample_approximate_voxel_grid.hpp"
#include "kernels/surfaces/subsample_by_normals.hpp"
#include "kernels/surfaces/subsample_voxel_grid.hpp"
#include "rows.hpp"
#include "support/reference.hpp"

namespace trivet::bench {
namespace {

constexpr float kCell = 0.01F;

Points naive_voxel_grid(PointsView points) {
  Points out;
  for (const auto& [voxel, indices] : reference::voxels(points, kCell)) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const std::uint32_t i : indices) sum += points[i].cast<double>();
    sum /= static_cast<double>(indices.size());
    out.push_back(sum.cast<float>());
  }
  return out;
}

const bool kOurs = add_rows("voxel_grid/ours", [](benchmark::State& state, const Scan& scan) {
  Points out;
  kernels::SubsampleScratch scratch;
  for (auto _ : state) kernels::subsample_voxel_grid(scan.points, kCell, out, scratch);
  state.counters["voxels"] = static_cast<double>(out.size());
  const Points expected = naive_voxel_grid(scan.points);
  double worst = out.size() == expected.size() ? 0 : 1;
  for (std::size_t i = 0; worst < 1 && i < out.size(); ++i) {
    worst = std::max(worst, double{(out[i] - expected[i]).norm()});
  }
  state.counters["error_m"] = worst;
});

const bool kNaive = add_rows("voxel_grid/naive", [](benchmark::State& state, const Scan& scan) {
  Points out;
  for (auto _ : state) out = naive_voxel_grid(scan.points);
  state.counters["voxels"] = static_cast<double>(out.size());
});

const bool kApproximate =
    add_rows("approximate_voxel_grid/ours", [](benchmark::State& state, const Scan& scan) {
      Points out;
      for (auto _ : state) kernels::subsample_approximate_voxel_grid(scan.points, kCell, out);
      state.counters["voxels"] = static_cast<double>(out.size());
    });

const bool kByNormals =
    add_rows("subsample_by_normals/ours", [](benchmark::State& state, const Scan& scan) {
      Points points;
      Normals normals;
      kernels::SubsampleScratch scratch;
      for (auto _ : state) {
        kernels::subsample_by_normals({scan.points, scan.truth}, kCell, 0.52F, points, normals,
                                      scratch);
      }
      state.counters["voxels"] = static_cast<double>(points.size());
    });

}  // namespace
}  // namespace trivet::bench

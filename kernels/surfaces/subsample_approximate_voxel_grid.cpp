#include "kernels/surfaces/subsample_approximate_voxel_grid.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "storage/common/precondition.hpp"

namespace trivet::kernels {
namespace {

struct RunningSum {
  Eigen::Vector3d voxel{0, 0, 0}, sum{0, 0, 0};  // voxel: whole numbers
  std::uint32_t count = 0;
};

constexpr int kTableBits = 9;

std::size_t slot_of(const Eigen::Vector3d& voxel) {
  std::uint64_t hash = 0;
  for (const double coordinate : voxel) {
    hash ^= std::bit_cast<std::uint64_t>(coordinate + 0.0);  // merges -0 and 0
    hash = (hash ^ hash >> 32) * 0x9E3779B97F4A7C15U;
  }
  return hash >> (64 - kTableBits);
}

void send_out(const RunningSum& entry, Points& out) {
  const Eigen::Vector3d centroid = entry.sum / static_cast<double>(entry.count);
  out.push_back(centroid.cast<float>());
}

}  // namespace

void subsample_approximate_voxel_grid(PointsView points, float cell, Points& out) {
  TRIVET_REQUIRE(cell > 0, "a voxel has an extent");
  const double inverse_cell = 1.0 / cell;
  std::array<RunningSum, std::size_t{1} << kTableBits> table;
  out.resize(0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d point = points[i].cast<double>();
    if (!point.allFinite()) continue;
    const Eigen::Vector3d voxel = (point * inverse_cell).array().floor();
    RunningSum& entry = table[slot_of(voxel)];
    if (entry.count > 0 && entry.voxel != voxel) {
      send_out(entry, out);
      entry = {};
    }
    entry.voxel = voxel;
    entry.sum += point;
    ++entry.count;
  }
  for (const RunningSum& entry : table) {
    if (entry.count > 0) send_out(entry, out);
  }
}

}  // namespace trivet::kernels

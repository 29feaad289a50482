#include "kernels/spin_images/support.hpp"

#include <algorithm>
#include <numbers>

namespace trivet::kernels {

void gather_support(const VoxelHash& grid, std::span<const float> areas,
                    const Eigen::Vector3f& keypoint, float radius, Support& support) {
  const auto reserve = [&](std::size_t n) {
    if (n <= support.x.size()) return;
    n = std::max(n, 2 * support.x.size());
    for (Column<float>* column : {&support.x, &support.y, &support.z, &support.area})
      column->resize(n);
  };
  support.size = 0;
  grid.visit_runs_within(keypoint, radius, [&](PointsView points, const std::uint32_t* indices) {
    const std::size_t n = points.size(), before = support.size;
    reserve(before + n + Support::kLanes);
    const float px = keypoint.x(), py = keypoint.y(), pz = keypoint.z();
    const float limit = radius * radius;
    float *const x = support.x.data() + before, *const y = support.y.data() + before;
    float *const z = support.z.data() + before, *const area = support.area.data() + before;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < n; ++i) {  // branch-free: entries that are too far are overwritten
      const float dx = points.x[i] - px, dy = points.y[i] - py, dz = points.z[i] - pz;
      x[kept] = dx;
      y[kept] = dy;
      z[kept] = dz;
      area[kept] = areas.empty() ? 1 : areas[indices[i]];
      kept += dx * dx + dy * dy + dz * dz <= limit;
    }
    support.size += kept;
  });
  reserve(support.size + Support::kLanes);
  for (Column<float>* column : {&support.x, &support.y, &support.z, &support.area})
    std::fill_n(column->begin() + static_cast<std::ptrdiff_t>(support.size), Support::kLanes, 0.0F);
}

void share_areas(const VoxelHash& grid, PointsView points, float radius,
                 std::span<float> areas) noexcept {
  const float disc = std::numbers::pi_v<float> * radius * radius;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::uint32_t sharers = grid.count_within(points[i], radius);
    areas[i] = sharers > 0 ? disc / static_cast<float>(sharers) : 0;
  }
}

}  // namespace trivet::kernels

#include "kernels/surfaces/subsample_by_normals.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "storage/common/precondition.hpp"
#include "storage/common/stop.hpp"

namespace trivet::kernels {
namespace {

void group_by_normal(PointsView points, NormalsView normals, std::span<const std::uint32_t> voxel,
                     float min_cosine, Column<OrientedGroup>& groups) {
  groups.clear();
  for (const std::uint32_t i : voxel) {
    const Eigen::Vector3f normal = normals[i];
    if (!normal.allFinite()) continue;
    auto group = std::ranges::find_if(
        groups, [&](const OrientedGroup& g) { return g.seed.dot(normal) >= min_cosine; });
    if (group == groups.end()) group = groups.insert(group, {.seed = normal});
    group->position_sum += points[i].cast<double>();
    group->normal_sum += normal.cast<double>();
    ++group->num_points;
  }
}

}  // namespace

void subsample_by_normals(const OrientedView& cloud, float cell, float max_angle_rad,
                          Points& out_points, Normals& out_normals, SubsampleScratch& scratch) {
  const auto& [points, normals] = cloud;
  TRIVET_REQUIRE(normals.size() == points.size(), "one normal per point");
  // From pi on every direction agrees, regardless of rounding of a dot product near -1.
  const float min_cosine = max_angle_rad < std::numbers::pi_v<float> ? std::cos(max_angle_rad) : -2;
  Voxels& voxels = scratch.voxels;
  group_by_voxel(points, fit_lattice(points, cell), voxels, scratch.grouping);
  out_points.resize(0);
  out_normals.resize(0);
  StopCheck check_stop(1 << 12);
  for (std::size_t v = 0; v < voxels.size(); ++v) {
    check_stop();
    group_by_normal(points, normals, voxels.points_of(v), min_cosine, scratch.groups);
    for (const OrientedGroup& group : scratch.groups) {
      const Eigen::Vector3d position = group.position_sum / static_cast<double>(group.num_points);
      const Eigen::Vector3d mean = group.normal_sum.normalized();
      out_points.push_back(position.cast<float>());
      out_normals.push_back(group.normal_sum.norm() > 0 ? Eigen::Vector3f(mean.cast<float>())
                                                        : Eigen::Vector3f(group.seed));
    }
  }
}

}  // namespace trivet::kernels

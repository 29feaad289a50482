#include "kernels/verification/cluster_poses.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include "kernels/common/pose_math.hpp"
#include "storage/common/clamped_integer.hpp"
#include "storage/common/stop.hpp"

namespace trivet::kernels {
namespace {

struct Cluster {
  std::vector<Pose> members;  // all in the branch of the first
  std::vector<Eigen::Vector3f> centers;
  std::vector<float> weights;
  float votes = 0;
};

/// A cell as one key. Cells are as wide as the translation limit, so a cluster's members lie in its
/// first one's cell or beside it. Distant cells may share a key, which costs time only.
std::int64_t cell_key(std::int64_t x, std::int64_t y, std::int64_t z) noexcept {
  return ((x & 0x1FFFFF) << 42) | ((y & 0x1FFFFF) << 21) | (z & 0x1FFFFF);
}

bool joins(const Cluster& cluster, const Pose& pose, const Eigen::Vector3f& center,
           const ClusterOptions& options) noexcept {
  const float max_squared = options.max_translation * options.max_translation;
  for (std::size_t m = 0; m < cluster.members.size(); ++m) {
    if ((cluster.centers[m] - center).squaredNorm() > max_squared) return false;
    if (rotation_angle(cluster.members[m].linear(), pose.linear()) > options.max_rotation_rad)
      return false;
  }
  return true;
}

}  // namespace

std::vector<Hypothesis> cluster_poses(std::span<const Hypothesis> hypotheses,
                                      const Symmetry& symmetry, const Eigen::Vector3f& model_center,
                                      const ClusterOptions& options) {
  std::vector<std::uint32_t> order(hypotheses.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return hypotheses[a].votes > hypotheses[b].votes;
  });

  std::vector<Cluster> clusters;
  std::unordered_map<std::int64_t, std::vector<std::uint32_t>> clusters_of_cell;
  for (const std::uint32_t i : order) {
    check_stop();
    const Eigen::Vector3f center = hypotheses[i].T_scene_model * model_center;
    const Eigen::Array3f scaled = (center / options.max_translation).array().floor();
    const auto cell = [](float coordinate) {
      constexpr std::int64_t kFarthest = std::int64_t{1} << 40;
      return clamped_integer(coordinate, -kFarthest, kFarthest);
    };
    const std::int64_t cx = cell(scaled.x()), cy = cell(scaled.y()), cz = cell(scaled.z());

    // The strongest fitting cluster has the lowest index, in whatever cell it is found.
    std::uint32_t best = static_cast<std::uint32_t>(clusters.size());
    Pose best_pose = hypotheses[i].T_scene_model;
    for (std::int64_t dx = -1; dx <= 1; ++dx) {
      for (std::int64_t dy = -1; dy <= 1; ++dy) {
        for (std::int64_t dz = -1; dz <= 1; ++dz) {
          const auto found = clusters_of_cell.find(cell_key(cx + dx, cy + dy, cz + dz));
          if (found == clusters_of_cell.end()) continue;
          for (const std::uint32_t c : found->second) {
            if (c >= best) break;
            const Pose pose = symmetry.trivial()
                                  ? hypotheses[i].T_scene_model
                                  : closest_equivalent(hypotheses[i].T_scene_model, symmetry,
                                                       clusters[c].members.front());
            if (!joins(clusters[c], pose, pose * model_center, options)) continue;
            best = c;
            best_pose = pose;
            break;
          }
        }
      }
    }
    if (best == clusters.size()) {
      clusters.emplace_back();
      clusters_of_cell[cell_key(cx, cy, cz)].push_back(best);
    }
    Cluster& cluster = clusters[best];
    cluster.members.push_back(best_pose);
    cluster.centers.push_back(best_pose * model_center);
    cluster.weights.push_back(hypotheses[i].votes);
    cluster.votes += hypotheses[i].votes;
  }

  std::vector<std::uint32_t> strongest(clusters.size());
  std::iota(strongest.begin(), strongest.end(), 0U);
  std::stable_sort(strongest.begin(), strongest.end(), [&](std::uint32_t a, std::uint32_t b) {
    return clusters[a].votes > clusters[b].votes;
  });
  strongest.resize(std::min(strongest.size(), options.max_clusters));

  std::vector<Hypothesis> out;
  out.reserve(strongest.size());
  for (const std::uint32_t c : strongest) {
    out.push_back(
        {mean_pose(clusters[c].members, clusters[c].weights, model_center), clusters[c].votes});
  }
  return out;
}

}  // namespace trivet::kernels

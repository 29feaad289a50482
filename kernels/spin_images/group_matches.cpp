#include "kernels/spin_images/group_matches.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "kernels/common/counter_random.hpp"
#include "storage/common/precondition.hpp"
#include "storage/common/stop.hpp"

namespace trivet::kernels {
namespace {

/// Whether the points of two correspondences are as far apart in the scene as in the model.
bool agree(const PointMatches& matches, std::uint32_t i, std::uint32_t j, float tolerance) {
  const float scene = (matches.scene[i] - matches.scene[j]).norm();
  const float model = (matches.model[i] - matches.model[j]).norm();
  return std::abs(scene - model) <= tolerance;
}

}  // namespace

Pose fit_pose(const PointMatches& matches, std::span<const std::uint32_t> chosen) {
  TRIVET_REQUIRE(chosen.size() >= 3, "three matches or more");
  const auto n = static_cast<Eigen::Index>(chosen.size());
  Eigen::Matrix3Xd from(3, n), to(3, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const std::uint32_t i = chosen[static_cast<std::size_t>(k)];
    from.col(k) = matches.model[i].cast<double>();
    to.col(k) = matches.scene[i].cast<double>();
  }
  Pose pose;
  pose.matrix() = Eigen::umeyama(from, to, false).cast<float>();
  return pose;
}

std::vector<Hypothesis> group_by_consistency(const PointMatches& matches, float tolerance,
                                             std::size_t min_size) {
  const auto n = static_cast<std::uint32_t>(matches.scene.size());
  std::vector<std::uint8_t> is_grouped(n, 0);
  std::vector<std::uint32_t> group;
  std::vector<Hypothesis> found;
  for (std::uint32_t first = 0; first < n; ++first) {
    if (is_grouped[first] != 0) continue;
    check_stop();
    group.assign(1, first);
    for (std::uint32_t i = first + 1; i < n; ++i) {
      if (is_grouped[i] != 0) continue;
      const bool fits = std::ranges::all_of(
          group, [&](std::uint32_t member) { return agree(matches, member, i, tolerance); });
      if (fits) group.push_back(i);
    }
    if (group.size() < min_size) continue;
    for (const std::uint32_t i : group) is_grouped[i] = 1;
    found.push_back({fit_pose(matches, group), static_cast<float>(group.size())});
  }
  std::ranges::stable_sort(found, std::ranges::greater(), &Hypothesis::votes);
  return found;
}

std::vector<Hypothesis> group_by_ransac(const PointMatches& matches, float tolerance,
                                        std::size_t min_size, std::uint32_t num_draws,
                                        std::uint64_t seed) {
  const auto n = static_cast<std::uint32_t>(matches.scene.size());
  std::vector<std::uint32_t> inliers;
  std::vector<Hypothesis> found;
  if (n < 3) return found;
  for (std::uint32_t draw = 0; draw < num_draws; ++draw) {
    CounterRandom random(seed, 0, draw);
    std::array<std::uint32_t, 3> triple{};
    for (std::uint32_t& i : triple) i = static_cast<std::uint32_t>(random.next() % n);
    const auto [a, b, c] = triple;
    // Coincident points do not determine a pose.
    const auto holds = [&](std::uint32_t i, std::uint32_t j) {
      return (matches.model[i] - matches.model[j]).norm() > 2 * tolerance &&
             agree(matches, i, j, tolerance);
    };
    if (!holds(a, b) || !holds(b, c) || !holds(c, a)) continue;
    check_stop();
    const Pose pose = fit_pose(matches, triple);
    inliers.clear();
    for (std::uint32_t i = 0; i < n; ++i) {
      if ((pose * matches.model[i] - matches.scene[i]).squaredNorm() <= tolerance * tolerance)
        inliers.push_back(i);
    }
    if (inliers.size() < std::max<std::size_t>(min_size, 3)) continue;
    found.push_back({fit_pose(matches, inliers), static_cast<float>(inliers.size())});
  }
  return found;
}

}  // namespace trivet::kernels

#include "kernels/spin_images/group_matches.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "kernels/common/pose_math.hpp"
#include "support/random.hpp"

namespace trivet::kernels {
namespace {

struct Matched {
  Points scene, model;
  PointMatches view() const { return {scene, model}; }
};

/// A shuffled set of `right` matches that fit the pose with a little noise and `wrong` random ones.
Matched mix(test::Random& random, const std::vector<Pose>& poses, std::size_t right,
            std::size_t wrong) {
  Matched out;
  const auto anywhere = [&] {
    return Eigen::Vector3f(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  };
  for (std::size_t k = 0; k < right + wrong; ++k) {
    const Eigen::Vector3f p = anywhere();
    out.model.push_back(p);
    if (k < right) {
      out.scene.push_back(poses[k % poses.size()] * p + 0.001F * anywhere());
    } else {
      out.scene.push_back(5 * anywhere());
    }
  }
  return out;
}

void expect_near(const Pose& found, const Pose& truth) {
  const PoseDistance error = pose_distance(found, truth, {}, Eigen::Vector3f::Zero());
  EXPECT_LT(error.translation, 0.005F);
  EXPECT_LT(error.rotation_rad, 0.005F);
}

std::vector<Pose> two_poses(test::Random& random) { return {random.motion(), random.motion()}; }

TEST(FitPose, MapsOnePointSetToTheOther) {
  test::Random random;
  for (int i = 0; i < 20; ++i) {
    const Pose truth = random.motion();
    const Matched matched = mix(random, {truth}, 12, 0);
    std::vector<std::uint32_t> all(12);
    std::iota(all.begin(), all.end(), 0U);
    expect_near(fit_pose(matched.view(), all), truth);
    EXPECT_GT(fit_pose(matched.view(), all).linear().determinant(), 0.999F);
  }
}

TEST(GroupByConsistency, FindsEachPoseAmongWrongMatches) {
  test::Random random;
  const std::vector<Pose> poses = two_poses(random);
  const Matched matched = mix(random, poses, 60, 150);
  const std::vector<Hypothesis> found = group_by_consistency(matched.view(), 0.01F, 10);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_TRUE(std::ranges::is_sorted(found, std::ranges::greater(), &Hypothesis::votes));
  for (const Hypothesis& hypothesis : found) {
    EXPECT_GE(hypothesis.votes, 28);
    const bool first = (hypothesis.T_scene_model.linear() - poses[0].linear()).norm() < 0.1F;
    expect_near(hypothesis.T_scene_model, poses[first ? 0 : 1]);
  }
  EXPECT_TRUE(group_by_consistency(matched.view(), 0.01F, 40).empty());
}

TEST(GroupByRansac, FindsThePoseOfManyMatches) {
  test::Random random;
  const std::vector<Pose> poses{random.motion()};
  const Matched matched = mix(random, poses, 60, 100);
  const std::vector<Hypothesis> found = group_by_ransac(matched.view(), 0.02F, 30, 2000, 7);
  ASSERT_FALSE(found.empty());
  for (const Hypothesis& hypothesis : found) {
    EXPECT_GE(hypothesis.votes, 55);
    expect_near(hypothesis.T_scene_model, poses[0]);
  }
  const std::vector<Hypothesis> again = group_by_ransac(matched.view(), 0.02F, 30, 2000, 7);
  ASSERT_EQ(again.size(), found.size());
  for (std::size_t k = 0; k < found.size(); ++k)
    EXPECT_EQ(again[k].T_scene_model.matrix(), found[k].T_scene_model.matrix());
}

TEST(GroupMatches, FindNothingInFewOrUnrelatedMatches) {
  test::Random random;
  for (const std::size_t n : {0, 1, 2, 3, 100}) {
    const Matched matched = mix(random, {random.motion()}, 0, n);
    EXPECT_TRUE(group_by_consistency(matched.view(), 0.01F, 6).empty()) << n;
    EXPECT_TRUE(group_by_ransac(matched.view(), 0.01F, 6, 500, 1).empty()) << n;
  }
}

}  // namespace
}  // namespace trivet::kernels

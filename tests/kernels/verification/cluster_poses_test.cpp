#include "kernels/verification/cluster_poses.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/random.hpp"
#include "support/reference_ppf.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;
using test::Random;

const Vector3f kCenter(0.3F, -0.2F, 0.5F);
const ClusterOptions kOptions{0.2F, 0.3F};

/// Hypotheses around a few places; those of one place are within about two limits of each other.
std::vector<Hypothesis> around_places(Random& random, std::size_t n, std::size_t places) {
  std::vector<Pose> middles;
  for (std::size_t k = 0; k < places; ++k) middles.push_back(random.motion(0.5F));
  std::vector<Hypothesis> out;
  for (std::size_t i = 0; i < n; ++i) {
    Pose pose = middles[random.below(static_cast<std::uint32_t>(places))] *
                test::turn_about(random.direction(), random.uniform(0, 0.3F), kCenter);
    pose.pretranslate(random.uniform(0, 0.2F) * random.direction());
    out.push_back({pose, 1 + 0.5F * static_cast<float>(random.below(40))});  // ties, exact sums
  }
  return out;
}

struct NaiveCluster {
  std::vector<Eigen::Matrix3d> rotations;
  std::vector<Eigen::Vector3d> centers;
  std::vector<double> weights;
  double votes = 0;
};

/// Complete linkage from its definition: every member of every cluster is compared.
std::vector<NaiveCluster> naive_clusters(std::vector<Hypothesis> hypotheses) {
  std::ranges::stable_sort(hypotheses, std::ranges::greater{}, &Hypothesis::votes);
  std::vector<NaiveCluster> clusters;
  for (const Hypothesis& h : hypotheses) {
    const Eigen::Matrix3d R = h.T_scene_model.linear().cast<double>();
    const Eigen::Vector3d center =
        R * kCenter.cast<double>() + h.T_scene_model.translation().cast<double>();
    const auto fits = [&](const NaiveCluster& cluster) {
      for (std::size_t m = 0; m < cluster.centers.size(); ++m) {
        if ((cluster.centers[m] - center).norm() > static_cast<double>(kOptions.max_translation) ||
            reference::rotation_angle(cluster.rotations[m], R) >
                static_cast<double>(kOptions.max_rotation_rad)) {
          return false;
        }
      }
      return true;
    };
    auto found = std::ranges::find_if(clusters, fits);
    if (found == clusters.end()) found = clusters.insert(clusters.end(), NaiveCluster{});
    found->rotations.push_back(R);
    found->centers.push_back(center);
    found->weights.push_back(static_cast<double>(h.votes));
    found->votes += static_cast<double>(h.votes);
  }
  std::ranges::stable_sort(clusters, std::ranges::greater{}, &NaiveCluster::votes);
  return clusters;
}

TEST(ClusterPoses, FollowsTheRuleOfCompleteLinkage) {
  for (const std::size_t n : {0U, 1U, 2U, 30U, 400U}) {
    Random random(n);
    const std::vector<Hypothesis> hypotheses = around_places(random, n, 1 + n / 20);
    const auto expected = naive_clusters(hypotheses);
    const auto found = cluster_poses(hypotheses, {}, kCenter, kOptions);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t k = 0; k < found.size(); ++k) {
      EXPECT_EQ(found[k].votes, expected[k].votes);
      Eigen::Vector3d center = Eigen::Vector3d::Zero();
      for (std::size_t m = 0; m < expected[k].centers.size(); ++m) {
        center += expected[k].weights[m] / expected[k].votes * expected[k].centers[m];
      }
      EXPECT_LT(((found[k].T_scene_model * kCenter).cast<double>() - center).norm(), 1e-5);
      EXPECT_LT((found[k].T_scene_model.linear().cast<double>() -
                 reference::mean_rotation(expected[k].rotations, expected[k].weights))
                    .norm(),
                1e-5);
    }
    if (n == 400) {
      EXPECT_GT(found.size(), 30U);
      EXPECT_LT(found.size(), 300U);
    }
  }
}

/// Poses at steps of a shift and a rotation: each is within both limits of the next.
std::vector<Hypothesis> chain(std::size_t n, float shift, float angle) {
  std::vector<Hypothesis> out;
  for (std::size_t i = 0; i < n; ++i) {
    const auto k = static_cast<float>(i);
    Pose pose = test::turn_about(Vector3f::UnitZ(), angle * k, kCenter);
    pose.pretranslate(Vector3f(shift * k, 0, 0));
    out.push_back({pose, 1});
  }
  return out;
}

TEST(ClusterPoses, NeverChains) {
  for (const auto& [shift, angle] : {std::pair{0.15F, 0.0F}, std::pair{0.0F, 0.2F}}) {
    const auto found = cluster_poses(chain(20, shift, angle), {}, kCenter, kOptions);
    ASSERT_EQ(found.size(), 10U);
    for (const Hypothesis& cluster : found) EXPECT_EQ(cluster.votes, 2);
  }
}

TEST(ClusterPoses, TreatsSymmetricPosesAsOne) {
  Random random;
  const float pi = static_cast<float>(reference::kPi);
  std::vector<Symmetry> symmetries(3);
  symmetries[0].poses = test::turns(12, Vector3f::UnitX(), kCenter);
  symmetries[1].axis = Symmetry::Axis{random.direction(), kCenter};
  symmetries[2].axis = Symmetry::Axis{Vector3f::UnitX(), kCenter};
  symmetries[2].poses.push_back(test::turn_about(Vector3f::UnitY(), pi, kCenter));
  for (const Symmetry& symmetry : symmetries) {
    const Pose place = random.motion();
    std::vector<Hypothesis> hypotheses;
    for (int i = 0; i < 100; ++i) {
      Pose S = Pose::Identity();
      if (!symmetry.poses.empty()) {
        S = symmetry.poses[random.below(static_cast<std::uint32_t>(symmetry.poses.size()))];
      }
      if (symmetry.axis) {
        S = S * test::turn_about(symmetry.axis->direction, random.uniform(-3, 3), kCenter);
      }
      Pose pose =
          place * test::turn_about(random.direction(), random.uniform(0, 0.05F), kCenter) * S;
      pose.pretranslate(random.uniform(0, 0.05F) * random.direction());
      hypotheses.push_back({pose, 1});
    }
    const auto found = cluster_poses(hypotheses, symmetry, kCenter, kOptions);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].votes, 100);
    EXPECT_LT((found[0].T_scene_model * kCenter - place * kCenter).norm(), 0.03F);
    if (!symmetry.axis) {  // the mean is in some branch: one of the twelve equivalents
      double nearest = reference::rotation_angle(found[0].T_scene_model, place);
      for (const Pose& S : symmetry.poses) {
        nearest = std::min(nearest, reference::rotation_angle(found[0].T_scene_model, place * S));
      }
      EXPECT_LT(nearest, 0.02);
    }
    EXPECT_GT(cluster_poses(hypotheses, {}, kCenter, kOptions).size(), 3U) << "without symmetry";
  }
}

TEST(ClusterPoses, DoesNotDependOnTheOrderWhenVotesDiffer) {
  Random random;
  std::vector<Hypothesis> hypotheses = around_places(random, 200, 10);
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    hypotheses[i].votes = 1 + static_cast<float>(i) / 256;
  }
  const auto before = cluster_poses(hypotheses, {}, kCenter, kOptions);
  std::vector<Hypothesis> shuffled;
  for (const std::uint32_t i : random.permutation(200)) shuffled.push_back(hypotheses[i]);
  const auto after = cluster_poses(shuffled, {}, kCenter, kOptions);
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t k = 0; k < after.size(); ++k) {
    EXPECT_EQ(after[k].votes, before[k].votes);
    EXPECT_EQ(after[k].T_scene_model.matrix(), before[k].T_scene_model.matrix());
  }
}

TEST(ClusterPoses, KeepsTheStrongestOnes) {
  Random random;
  const std::vector<Hypothesis> hypotheses = around_places(random, 200, 20);
  const auto all = cluster_poses(hypotheses, {}, kCenter, kOptions);
  ClusterOptions few = kOptions;
  few.max_clusters = 5;
  const auto kept = cluster_poses(hypotheses, {}, kCenter, few);
  ASSERT_EQ(kept.size(), 5U);
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_EQ(kept[k].votes, all[k].votes);
    EXPECT_GE(kept[k].votes, all[k + 1].votes);
  }
}

}  // namespace
}  // namespace trivet::kernels

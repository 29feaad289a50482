#include "kernels/common/pose_math.hpp"

#include <gtest/gtest.h>

#include "support/random.hpp"
#include "support/reference_ppf.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;
using test::Random;

const Vector3f kCenter(0.3F, -0.2F, 0.5F);

Pose turned(const Pose& pose, const Vector3f& axis, float angle) {
  Pose T = Pose::Identity();
  T.linear() = Eigen::AngleAxisf(angle, axis).toRotationMatrix();
  return pose * T;
}

/// Symmetries of a box, a 12-fold gear, a can, and a can that can be turned over.
std::vector<Symmetry> symmetries(Random& random) {
  const float pi = static_cast<float>(reference::kPi);
  const Vector3f axis = random.direction(), side = axis.unitOrthogonal();
  std::vector<Symmetry> out(4);
  for (int k = 0; k < 3; ++k) {
    out[0].poses.push_back(test::turn_about(Vector3f::Unit(k), pi, kCenter));
  }
  out[1].poses = test::turns(12, axis, kCenter);
  out[2].axis = Symmetry::Axis{axis, kCenter + 2.0F * axis};
  out[3].axis = Symmetry::Axis{axis, kCenter - axis};
  out[3].poses.push_back(test::turn_about(side, pi, kCenter));
  return out;
}

/// A random symmetry: a listed one, then any rotation about the axis.
Pose random_symmetry(Random& random, const Symmetry& symmetry) {
  Pose S = Pose::Identity();
  const std::uint32_t k = random.below(static_cast<std::uint32_t>(symmetry.poses.size()) + 1);
  if (k > 0) S = symmetry.poses[k - 1];
  if (symmetry.axis) {
    S = S * test::turn_about(symmetry.axis->direction, random.uniform(-3, 3), symmetry.axis->point);
  }
  return S;
}

/// The smallest rotation between a pose's equivalents and a target, by exhaustive search.
double closest_by_trial(const Pose& pose, const Symmetry& symmetry, const Pose& target) {
  constexpr int kSteps = 7200;
  double best = 4;
  for (std::size_t k = 0; k <= symmetry.poses.size(); ++k) {
    const Pose S = k > 0 ? pose * symmetry.poses[k - 1] : pose;
    for (int step = 0; step < (symmetry.axis ? kSteps : 1); ++step) {
      Pose turn = Pose::Identity();
      if (symmetry.axis) {
        turn = test::turn_about(symmetry.axis->direction,
                                static_cast<float>(2 * reference::kPi * step / kSteps),
                                symmetry.axis->point);
      }
      best = std::min(best, reference::rotation_angle(S * turn, target));
    }
  }
  return best;
}

TEST(RotationAngle, IsTheAngleTurnedFromTinyToHalfATurn) {
  Random random;
  for (const double angle : {0.0, 1e-5, 1e-3, 0.1, 1.0, 2.0, 3.0, 3.14, reference::kPi}) {
    for (int trial = 0; trial < 20; ++trial) {
      const Pose a = random.motion();
      const Pose b = turned(a, random.direction(), static_cast<float>(angle));
      // asin is steep near a half turn, where a rounding error of 1e-7 becomes its square root.
      const double tolerance = std::min(2e-3, 5e-7 / std::cos(angle / 2));
      EXPECT_NEAR(rotation_angle(a.linear(), b.linear()), angle, tolerance);
      EXPECT_EQ(rotation_angle(a.linear(), b.linear()), rotation_angle(b.linear(), a.linear()));
    }
  }
}

TEST(ClosestEquivalent, IsTheBestOfAllEquivalents) {
  Random random;
  for (const Symmetry& symmetry : symmetries(random)) {
    for (int trial = 0; trial < 20; ++trial) {
      const Pose pose = random.motion(), target = random.motion();
      const Pose found = closest_equivalent(pose, symmetry, target);
      const double best = closest_by_trial(pose, symmetry, target);
      // The trials are 0.05 degrees apart; the true minimum lies below them.
      EXPECT_LE(reference::rotation_angle(found, target), best + 2e-3);
      EXPECT_GE(reference::rotation_angle(found, target), best - 1e-3);
      EXPECT_LT((found * kCenter - pose * kCenter).norm(), 1e-5) << "every symmetry keeps it";
    }
  }
}

TEST(ClosestEquivalent, FindsTheTargetAmongItsEquivalents) {
  Random random;
  for (const Symmetry& symmetry : symmetries(random)) {
    for (int trial = 0; trial < 50; ++trial) {
      const Pose target = random.motion();
      const Pose pose = target * random_symmetry(random, symmetry);
      const Pose found = closest_equivalent(pose, symmetry, target);
      EXPECT_LT((found.matrix() - target.matrix()).norm(), 2e-5);
    }
  }
}

TEST(ClosestEquivalent, WithoutSymmetryIsThePose) {
  Random random;
  const Pose pose = random.motion();
  EXPECT_EQ(closest_equivalent(pose, {}, random.motion()).matrix(), pose.matrix());
}

TEST(PoseDistance, IsZeroBetweenSymmetricEquivalents) {
  Random random;
  for (const Symmetry& symmetry : symmetries(random)) {
    for (int trial = 0; trial < 50; ++trial) {
      const Pose a = random.motion();
      const PoseDistance d =
          pose_distance(a, a * random_symmetry(random, symmetry), symmetry, kCenter);
      EXPECT_LT(d.translation, 1e-5);
      EXPECT_LT(d.rotation_rad, 2e-5);
    }
  }
}

// Shifts by t and turns about the center by less than half of the symmetry's angles.
TEST(PoseDistance, MeasuresAtTheCenterAndSparesTheFreeTurn) {
  Random random;
  const Symmetry gear = symmetries(random)[1], can = symmetries(random)[2];
  for (const Symmetry& symmetry : {Symmetry{}, gear, can}) {
    for (int trial = 0; trial < 50; ++trial) {
      const Pose a = random.motion();
      const Vector3f shift = random.uniform(0, 0.5F) * random.direction();
      const float angle = random.uniform(0, 0.2F);
      const Vector3f about =
          symmetry.axis ? Vector3f(symmetry.axis->direction).unitOrthogonal() : random.direction();
      Pose b = a * test::turn_about(about, angle, kCenter) * random_symmetry(random, symmetry);
      b.pretranslate(shift);
      const PoseDistance d = pose_distance(a, b, symmetry, kCenter);
      EXPECT_NEAR(d.translation, shift.norm(), 1e-5);
      EXPECT_NEAR(d.rotation_rad, angle, 2e-5);
    }
  }
}

struct Weighted {
  std::vector<Pose> poses;
  std::vector<float> weights;
};

Weighted around(Random& random, const Pose& middle, std::size_t n, float angle) {
  Weighted out;
  for (std::size_t i = 0; i < n; ++i) {
    Pose pose = turned(middle, random.direction(), random.uniform(0, angle));
    pose.pretranslate(0.1F * random.direction());
    out.poses.push_back(pose);
    out.weights.push_back(random.uniform(0.1F, 5));
  }
  return out;
}

TEST(MeanPose, IsTheLeastSquaresMeanOfTheRotationsAndCenters) {
  for (const std::size_t n : {1U, 2U, 3U, 50U}) {
    Random random(n);
    for (int trial = 0; trial < 20; ++trial) {
      const auto [poses, weights] = around(random, random.motion(), n, 0.5F);
      std::vector<Eigen::Matrix3d> rotations;
      Eigen::Vector3d center = Eigen::Vector3d::Zero();
      double sum = 0;
      for (std::size_t i = 0; i < n; ++i) {
        rotations.push_back(poses[i].linear().cast<double>());
        center += static_cast<double>(weights[i]) * (poses[i] * kCenter).cast<double>();
        sum += static_cast<double>(weights[i]);
      }
      const Pose found = mean_pose(poses, weights, kCenter);
      const Eigen::Matrix3d expected =
          reference::mean_rotation(rotations, {weights.begin(), weights.end()});
      EXPECT_LT((found.linear().cast<double>() - expected).norm(), 3e-6);
      EXPECT_LT(((found * kCenter).cast<double>() - center / sum).norm(), 3e-6);
    }
  }
}

// Just below and above a half turn, quaternions of similar rotations have opposite signs.
TEST(MeanPose, DoesNotDependOnQuaternionSigns) {
  const Vector3f axis = Vector3f(1, -2, 0.5F).normalized();
  const float pi = static_cast<float>(reference::kPi);
  const Pose id = Pose::Identity();
  const std::vector<Pose> poses{turned(id, axis, pi - 0.1F), turned(id, axis, pi + 0.1F)};
  const Pose mean = mean_pose(poses, std::vector<float>{2, 2}, kCenter);
  EXPECT_LT(reference::rotation_angle(mean, turned(id, axis, pi)), 1e-3);
}

TEST(MeanPose, MovedToOneBranchIgnoresSymmetry) {
  Random random;
  for (const Symmetry& symmetry : symmetries(random)) {
    const Pose middle = random.motion();
    auto [poses, weights] = around(random, middle, 30, 0.05F);
    const Pose plain = mean_pose(poses, weights, kCenter);
    for (Pose& pose : poses) {
      pose = closest_equivalent(pose * random_symmetry(random, symmetry), symmetry, plain);
    }
    const PoseDistance d =
        pose_distance(plain, mean_pose(poses, weights, kCenter), symmetry, kCenter);
    EXPECT_LT(d.translation, 1e-5);
    EXPECT_LT(d.rotation_rad, 2e-3);  // with a free axis each member is turned a little
  }
}

TEST(SmallMotion, TurnsAboutThePivotAndThenShifts) {
  Random random;
  for (int trial = 0; trial < 50; ++trial) {
    const Vector3f w = random.uniform(0, 3) * random.direction(), t = random.direction();
    const Vector3f pivot = 2.0F * random.direction();
    const Pose motion = small_motion(w, t, pivot);
    EXPECT_LT((motion * pivot - (pivot + t)).norm(), 2e-6);
    EXPECT_NEAR(reference::rotation_angle(motion, Pose::Identity()), w.norm(), 1e-5);
    EXPECT_LT((motion.linear() * w - w).norm(), 5e-6);
    EXPECT_GT((motion.linear() * w.unitOrthogonal()).dot(w.cross(w.unitOrthogonal())) *
                  std::sin(w.norm()),
              0)
        << "right-handed";
  }
  EXPECT_EQ(small_motion(Vector3f::Zero(), Vector3f::Zero(), kCenter).matrix(),
            Pose::Identity().matrix());
}

// d(p)/d(w, t) at zero is [-(p - pivot)x, I], the columns of the refinement's Jacobian.
TEST(SmallMotion, HasTheDerivativeOfItsCentralDifferences) {
  Random random;
  // The error of central differences is the square of the step over 6, below the rounding error of
  // 1e-5.
  constexpr float kStep = 1e-2F;
  for (int trial = 0; trial < 20; ++trial) {
    const Vector3f pivot = random.direction(), p = pivot + random.direction();
    for (int k = 0; k < 3; ++k) {
      const Vector3f e = kStep * Vector3f::Unit(k), zero = Vector3f::Zero();
      const Vector3f by_w =
          (small_motion(e, zero, pivot) * p - small_motion(-e, zero, pivot) * p) / (2 * kStep);
      const Vector3f by_t =
          (small_motion(zero, e, pivot) * p - small_motion(zero, -e, pivot) * p) / (2 * kStep);
      EXPECT_LT((by_w - Vector3f::Unit(k).cross(p - pivot)).norm(), 1e-4);
      EXPECT_LT((by_t - Vector3f::Unit(k)).norm(), 1e-4);
    }
  }
}

}  // namespace
}  // namespace trivet::kernels

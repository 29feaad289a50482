#include "kernels/simulation/solid.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "support/allocations.hpp"
#include "support/random_solid.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;
using test::Random;

Vector3f random_point(Random& random) {
  return {random.uniform(-1.2F, 1.2F), random.uniform(-1.2F, 1.2F), random.uniform(-1.2F, 1.2F)};
}

/// Whether the solid's sign agrees with a membership test, away from the border.
template <class Holds>
void expect_holds(const Solid& solid, Holds&& holds) {
  Random random;
  int num_inside = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vector3f p = random_point(random);
    const float distance = solid.distance(p);
    if (std::abs(distance) < 1e-5F) continue;
    num_inside += distance < 0;
    ASSERT_EQ(distance < 0, holds(p.cast<double>().eval())) << p.transpose();
    if (distance < 0) {
      ASSERT_TRUE(solid.bounds().contains(p)) << p.transpose();
    }
  }
  EXPECT_GT(num_inside, 40);
}

double radius(const Eigen::Vector3d& p) { return p.head<2>().norm(); }

TEST(Solid, PrimitivesHoldWhatTheyAreDefinedBy) {
  expect_holds(box({0.5F, 0.3F, 0.8F}), [](const Eigen::Vector3d& p) {
    return (p.array().abs() < Eigen::Array3d(0.5, 0.3, 0.8)).all();
  });
  const Vector3f normal = Vector3f(1, 2, -2) / 3;
  expect_holds(half_space(normal, 0.2F), [](const Eigen::Vector3d& p) {
    return (p.x() + 2 * p.y() - 2 * p.z()) / 3 < static_cast<double>(0.2F);
  });
  // A ring with a triangular cross section.
  expect_holds(turned(std::array<Vector2f, 3>{{{0.4F, -0.5F}, {1, 0}, {0.4F, 0.5F}}}),
               [](const Eigen::Vector3d& p) {
                 const double left = radius(p) - static_cast<double>(0.4F);
                 return left > 0 &&
                        left < (1 - static_cast<double>(0.4F)) * (1 - 2 * std::abs(p.z()));
               });
  expect_holds(torus(0.7F, 0.25F), [](const Eigen::Vector3d& p) {
    return std::hypot(radius(p) - static_cast<double>(0.7F), p.z()) < 0.25;
  });
  // The hull of two discs: discs whose center and radius are interpolated between the two.
  expect_holds(oblong(0.5F, 0.2F, 0.6F), [](const Eigen::Vector3d& p) {
    double least = 1;
    for (int k = 0; k <= 100'000; ++k) {
      const double share = k / 100'000.0;
      least = std::min(least, std::hypot(p.x() - 0.6 * share, p.y()) - (0.5 - 0.3 * share));
    }
    return least < 0;
  });
}

TEST(Solid, CompositionsHoldWhatTheirPartsHold) {
  Random random;
  const Solid a = moved(box({0.6F, 0.5F, 0.4F}), test::random_pose(random, 0.2F));
  const Solid b = moved(torus(0.5F, 0.3F), test::random_pose(random, 0.2F));
  const auto in = [](const Solid& solid, const Eigen::Vector3d& p) {
    return solid.distance(p.cast<float>()) < 0;
  };
  expect_holds(a | b, [&](const auto& p) { return in(a, p) || in(b, p); });
  expect_holds(a & b, [&](const auto& p) { return in(a, p) && in(b, p); });
  expect_holds(a - b, [&](const auto& p) { return in(a, p) && !in(b, p); });
  expect_holds(mirrored_x(a), [&](const auto& p) { return in(a, {-p.x(), p.y(), p.z()}); });
  const Pose motion = test::random_pose(random, 0.3F);
  expect_holds(moved(a, motion),
               [&](const auto& p) { return in(a, motion.inverse().template cast<double>() * p); });
}

TEST(Solid, CopiesAroundTheAxisAreTurnedAndMirrored) {
  Random random;
  for (const std::uint32_t n : {2U, 3U, 5U, 12U}) {
    const Solid a = moved(box({0.4F, 0.3F, 0.5F}), test::random_pose(random, 0.3F));
    const Solid all = around_z(a, n);
    const float step = 2 * std::numbers::pi_v<float> / static_cast<float>(n);
    for (int i = 0; i < 500; ++i) {
      const float turn = random.uniform(0, step / 2), r = random.uniform(0, 1);
      const Vector3f p(r * std::cos(turn), r * std::sin(turn), random.uniform(-1, 1));
      for (std::uint32_t k = 0; k < n; ++k) {
        const Eigen::AngleAxisf turned(static_cast<float>(k) * step, Vector3f::UnitZ());
        EXPECT_NEAR(all.distance(turned * p), a.distance(p), 2e-6F);
        EXPECT_NEAR(all.distance(turned * Vector3f(p.x(), -p.y(), p.z())), a.distance(p), 2e-6F);
      }
    }
  }
}

TEST(Solid, BlendAddsToTheUnionOnlyWhereBothAreNear) {
  Random random;
  const Solid a = box({1, 1, 0.2F}), b = box({0.2F, 0.2F, 1});
  const Solid blended = blend(a, b, 0.3F);
  for (int i = 0; i < 2000; ++i) {
    const Vector3f p = random_point(random);
    const float da = a.distance(p), db = b.distance(p), united = std::min(da, db);
    EXPECT_LE(blended.distance(p), united);
    EXPECT_GE(blended.distance(p), united - 0.3F / 4);
    if (std::abs(da - db) > 0.3F) {
      EXPECT_EQ(blended.distance(p), united);
    }
  }
  EXPECT_LT(blended.distance({0.25F, 0, 0.25F}), 0);  // in the corner
  EXPECT_GT((a | b).distance({0.25F, 0, 0.25F}), 0);
}

TEST(Solid, ChangesNoFasterThanTheDistance) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Random random(seed);
    const Solid solid = test::random_solid(random);
    for (int i = 0; i < 300; ++i) {
      const Vector3f p = random_point(random);
      const Vector3f q = p + random.uniform(0, 0.3F) * random.direction();
      EXPECT_LE(std::abs(solid.distance(p) - solid.distance(q)), 1.0001F * (p - q).norm() + 2e-6F)
          << "seed " << seed;
    }
  }
}

TEST(Solid, GradientIsThatOfCentralDifferences) {
  constexpr float kStep = 1e-3F;
  int num_smooth = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Random random(seed);
    const Solid solid = test::random_solid(random);
    for (int i = 0; i < 100; ++i) {
      const Vector3f p = random_point(random);
      Vector3f slope, curve;
      for (int k = 0; k < 3; ++k) {
        const Vector3f step = kStep * Vector3f::Unit(k);
        const float forward = solid.distance(p + step), backward = solid.distance(p - step);
        slope[k] = (forward - backward) / (2 * kStep);
        curve[k] = (forward + backward - 2 * solid.distance(p)) / kStep;
      }
      if (curve.norm() > 0.02F) continue;  // a crease lies between
      ++num_smooth;
      EXPECT_LT((solid.sample(p).gradient - slope).norm(), 0.02F) << "seed " << seed;
    }
  }
  EXPECT_GT(num_smooth, 3000);
}

TEST(Solid, RestrictedToABallHasTheSameValuesThere) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Random random(seed);
    const Solid solid = test::random_solid(random, 8);
    Solid near = solid;
    for (int i = 0; i < 50; ++i) {
      const Vector3f center = random_point(random);
      const float ball = random.uniform(0.01F, 0.3F);
      EXPECT_EQ(solid.restrict_to(center, ball, near), solid.distance(center));
      for (int k = 0; k < 10; ++k) {
        const Vector3f p = center + random.uniform(0, 0.999F) * ball * random.direction();
        // Rotation by a matrix instead of an angle: equal up to rounding.
        EXPECT_NEAR(near.distance(p), solid.distance(p), 1e-6F) << "seed " << seed;
      }
    }
  }
}

TEST(Solid, SamplingAllocatesNothing) {
  Random random;
  const Solid solid = test::random_solid(random, 8);
  float sum = 0;
  EXPECT_EQ(test::allocations_in([&] { sum += solid.distance({0.1F, 0.2F, 0.3F}); }), 0U);
  EXPECT_TRUE(std::isfinite(sum));
}

}  // namespace
}  // namespace trivet::kernels

#include "kernels/pair_features/pair_feature.hpp"

#include <gtest/gtest.h>

#include <array>

#include "support/allocations.hpp"
#include "support/random.hpp"
#include "support/reference_ppf.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;
using test::OrientedCloud;
using test::Random;

// fast_atan2 is accurate to 1e-6; the cross products of rounded unit normals add as much again.
constexpr double kAngleTolerance = 2e-6;

struct Features {
  explicit Features(std::size_t n) : distance(n), a1(n), a2(n), a3(n), rotation(n) {}
  PairFeaturesSpan span() { return {distance, a1, a2, a3, rotation}; }
  std::vector<float> distance, a1, a2, a3, rotation;
};

Features features_of(const ReferenceFrame& frame, PointsView points, NormalsView normals) {
  Features features(points.size());
  compute_pair_features(frame, points, normals, features.span());
  return features;
}

Features features_of(const OrientedCloud& cloud, std::size_t reference) {
  return features_of(reference_frame(cloud.points[reference], cloud.normals[reference]),
                     cloud.points, cloud.normals);
}

/// Directions at random, along the axes, and at the seam of the local frame's construction.
std::vector<Vector3f> directions(Random& random) {
  std::vector<Vector3f> out{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0},     {0, -1, 0},
                            {0, 0, 1}, {0, 0, -1}, {1, 0, -0.0F}, {0.6F, 0.8F, -1e-7F}};
  out.push_back(Vector3f(1e-4F, -1e-4F, -1).normalized());
  for (int i = 0; i < 100; ++i) out.push_back(random.direction());
  return out;
}

TEST(ReferenceFrame, IsARotationThatMapsThePointToTheOriginAndItsNormalToX) {
  Random random;
  for (const Vector3f& normal : directions(random)) {
    const Vector3f point = 3.0F * random.direction();
    const Pose T = frame_pose(reference_frame(point, normal));
    const Eigen::Matrix3d R = T.linear().cast<double>();
    EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 2e-6) << normal.transpose();
    EXPECT_NEAR(R.determinant(), 1, 2e-6) << normal.transpose();
    EXPECT_LT((T * point).norm(), 2e-6) << normal.transpose();
    EXPECT_LT((T.linear() * normal - Vector3f::UnitX()).norm(), 1e-6) << normal.transpose();
  }
}

TEST(PairFeature, AgreesWithTheDefinition) {
  for (const std::size_t n : test::kSmallSizes) {
    Random random(n);
    const OrientedCloud cloud = test::random_oriented(random, n);
    for (std::size_t r = 0; r < std::min<std::size_t>(n, 20); ++r) {
      const Features found = features_of(cloud, r);
      const Pose T = frame_pose(reference_frame(cloud.points[r], cloud.normals[r]));
      for (std::size_t i = 0; i < n; ++i) {
        if (i == r) continue;
        const auto expected = reference::pair_feature(cloud.points[r], cloud.normals[r],
                                                      cloud.points[i], cloud.normals[i], T);
        EXPECT_NEAR(found.distance[i], expected.distance, 1e-6);
        EXPECT_NEAR(found.a1[i], expected.angle_n1_d, kAngleTolerance);
        EXPECT_NEAR(found.a2[i], expected.angle_n2_d, kAngleTolerance);
        EXPECT_NEAR(found.a3[i], expected.angle_n1_n2, kAngleTolerance);
        // A point near the axis has an uncertain angle, so its position is compared instead.
        EXPECT_NEAR(std::remainder(found.rotation[i] - expected.rotation, 2 * reference::kPi) *
                        std::sin(expected.angle_n1_d),
                    0, kAngleTolerance);
      }
    }
  }
}

TEST(PairFeature, KnowsParallelOppositeAndCoincidentOnes) {
  Points points;
  Normals normals;
  for (const float along : {2.0F, -2.0F, 0.0F}) points.push_back({0, 0, along});
  normals.push_back({0, 0, 1});
  normals.push_back({0, 0, -1});
  normals.push_back({1, 0, 0});
  const Features f = features_of(reference_frame({0, 0, 0}, {0, 0, 1}), points, normals);
  const float pi = static_cast<float>(reference::kPi);
  EXPECT_EQ(f.distance, (std::vector<float>{2, 2, 0}));
  EXPECT_EQ(f.a1, (std::vector<float>{0, pi, 0}));
  EXPECT_EQ(f.a2, (std::vector<float>{0, 0, 0}));
  EXPECT_EQ(f.a3, (std::vector<float>{0, pi, pi / 2}));
  EXPECT_EQ(f.rotation, (std::vector<float>{0, 0, 0}));
}

TEST(PairFeature, RotationBringsTheSecondPointIntoTheUpperHalfPlane) {
  Random random;
  const OrientedCloud cloud = test::random_oriented(random, 200);
  const Features features = features_of(cloud, 0);
  const Pose T = frame_pose(reference_frame(cloud.points[0], cloud.normals[0]));
  for (std::size_t i = 1; i < 200; ++i) {
    const Vector3f turned =
        Eigen::AngleAxisf(features.rotation[i], Vector3f::UnitX()) * (T * cloud.points[i]);
    EXPECT_NEAR(turned.z(), 0, 1e-5);
    EXPECT_GE(turned.y(), 0);
  }
}

TEST(PairFeature, StaysUnderARigidMotion) {
  Random random;
  const OrientedCloud cloud = test::random_oriented(random, 100);
  const Features before = features_of(cloud, 0);
  for (int trial = 0; trial < 20; ++trial) {
    const Features after = features_of(test::moved(cloud, random.motion()), 0);
    for (std::size_t i = 1; i < 100; ++i) {
      EXPECT_NEAR(after.distance[i], before.distance[i], 2e-6);
      EXPECT_NEAR(after.a1[i], before.a1[i], 2e-5);  // moved points are rounded by 1e-7 each
      EXPECT_NEAR(after.a2[i], before.a2[i], 2e-5);
      EXPECT_NEAR(after.a3[i], before.a3[i], 2e-5);
    }
  }
}

// Drost et al., CVPR 2010, eq. (2): s = T_s^-1 R_x(alpha) T_m m with alpha = alpha_m - alpha_s.
TEST(PairFeature, SignFollowsFromTheRotation) {
  Random random;
  for (int trial = 0; trial < 500; ++trial) {
    const OrientedCloud model = test::random_oriented(random, 2);
    const Pose truth = random.motion();
    const OrientedCloud scene = test::moved(model, truth);
    const float alpha = features_of(model, 0).rotation[1] - features_of(scene, 0).rotation[1];
    const Pose T_m = frame_pose(reference_frame(model.points[0], model.normals[0]));
    const Pose T_s = frame_pose(reference_frame(scene.points[0], scene.normals[0]));
    Pose turn = Pose::Identity();
    turn.linear() = Eigen::AngleAxisf(alpha, Vector3f::UnitX()).toRotationMatrix();
    const Pose found = T_s.inverse() * turn * T_m;
    // The first point and normal agree by construction, the second point by the angle.
    EXPECT_LT((found * model.points[0] - scene.points[0]).norm(), 1e-5);
    EXPECT_LT((found * model.points[1] - scene.points[1]).norm(), 1e-5);
    EXPECT_LT((found.linear() * model.normals[1] - scene.normals[1]).norm(), 1e-3);
  }
}

TEST(PairFeature, GivesTheSameBitsForAnyChunking) {
  Random random;
  const OrientedCloud cloud = test::random_oriented(random, 77);
  const ReferenceFrame frame = reference_frame(cloud.points[0], cloud.normals[0]);
  const Features whole = features_of(cloud, 0);
  for (const std::size_t grain : {1U, 5U, 16U}) {
    test::for_chunks(77, grain, [&](std::size_t first, std::size_t count) {
      const Features part = features_of(frame, cloud.points.view().slice(first, count),
                                        cloud.normals.view().slice(first, count));
      for (const auto column : {&Features::distance, &Features::a1, &Features::a2, &Features::a3,
                                &Features::rotation}) {
        EXPECT_TRUE(test::same_bits(part.*column, std::span(whole.*column).subspan(first, count)));
      }
    });
  }
}

struct Keys {
  std::vector<std::uint32_t> cells;
  std::vector<std::uint16_t> rotations;
};

Keys quantized(const PpfQuantization& quantization, Features& features) {
  Keys keys{std::vector<std::uint32_t>(features.distance.size()),
            std::vector<std::uint16_t>(features.distance.size())};
  quantize_pair_features(quantization, features.span(), keys.cells, keys.rotations);
  return keys;
}

TEST(PairKey, AgreesWithTheDefinitionAwayFromBorders) {
  std::size_t judged = 0, inside = 0;
  for (const PpfQuantization& q : {PpfQuantization{0.1F, 20, 15}, PpfQuantization{0.25F, 8, 30}}) {
    Random random(q.num_angle_bins);
    const OrientedCloud cloud = test::random_oriented(random, 400);
    for (std::size_t r = 0; r < 20; ++r) {
      Features features = features_of(cloud, r);
      const Keys found = quantized(q, features);
      const Pose T = frame_pose(reference_frame(cloud.points[r], cloud.normals[r]));
      for (std::size_t i = 0; i < cloud.points.size(); ++i) {
        const auto f = reference::pair_feature(cloud.points[r], cloud.normals[r], cloud.points[i],
                                               cloud.normals[i], T);
        if (i != r && reference::near_border(f, q)) continue;
        const std::optional<std::uint32_t> expected = reference::cell_of(f, q);
        EXPECT_EQ(found.cells[i], expected.value_or(kNoCell));
        ++judged;
        if (!expected) continue;
        ++inside;
        EXPECT_LT(*expected, q.num_cells());
        if (std::sin(f.angle_n1_d) > 0.1) {
          EXPECT_LE(reference::units_between(found.rotations[i], reference::turn_units(f.rotation)),
                    0.6);  // rounding to integers, and 1e-6 rad is a hundredth
        }
      }
    }
  }
  EXPECT_GT(judged, 10'000U);
  EXPECT_GT(inside, 8'000U);
  EXPECT_LT(inside, judged - 300U);  // some are too far
}

TEST(PairKey, PutsHalfATurnInTheLastBinAndTheLimitOutside) {
  Features f(4);
  f.distance = {1.75F, 2.0F, 0.0F, 1e30F};
  const float pi = static_cast<float>(reference::kPi);
  for (auto* angle : {&f.a1, &f.a2, &f.a3}) angle->assign(4, pi);
  const PpfQuantization q{0.25F, 8, 15};
  EXPECT_EQ(quantized(q, f).cells,
            (std::vector<std::uint32_t>{q.num_cells() - 1, kNoCell, kNoCell, kNoCell}));
}

// A scene is quantized once for models of different sizes.
TEST(PairKey, IsThatOfALargerTable) {
  Random random;
  const OrientedCloud cloud = test::random_oriented(random, 200);
  Features features = features_of(cloud, 0);
  const PpfQuantization small{0.1F, 10, 15}, large{0.1F, 40, 15};
  const Keys a = quantized(small, features), b = quantized(large, features);
  for (std::size_t i = 0; i < 200; ++i) {
    EXPECT_EQ(a.cells[i], b.cells[i] < small.num_cells() ? b.cells[i] : kNoCell);
  }
}

TEST(QuantizeRotation, RoundsAndWrapsInSixteenBits) {
  const float pi = static_cast<float>(reference::kPi);
  EXPECT_EQ(quantize_rotation(0), 0);
  EXPECT_EQ(quantize_rotation(pi / 2), 1U << 14);
  EXPECT_EQ(quantize_rotation(-pi / 2), 3U << 14);
  EXPECT_EQ(quantize_rotation(pi), quantize_rotation(-pi));
  Random random;
  for (int i = 0; i < 1000; ++i) {
    const float a = random.uniform(-pi, pi), b = random.uniform(-pi, pi);
    EXPECT_LE(reference::units_between(quantize_rotation(a), reference::turn_units(a)), 0.52);
    const auto difference = static_cast<std::uint16_t>(quantize_rotation(a) - quantize_rotation(b));
    EXPECT_LE(
        reference::units_between(difference, reference::turn_units(static_cast<double>(a) - b)),
        1.04);
  }
}

TEST(PairFeature, AllocatesNothing) {
  Random random;
  const OrientedCloud cloud = test::random_oriented(random, 100);
  Features features(100);
  Keys keys{std::vector<std::uint32_t>(100), std::vector<std::uint16_t>(100)};
  EXPECT_EQ(test::allocations_in([&] {
              compute_pair_features(reference_frame(cloud.points[0], cloud.normals[0]),
                                    cloud.points, cloud.normals, features.span());
              quantize_pair_features({0.1F, 20, 15}, features.span(), keys.cells, keys.rotations);
            }),
            0U);
}

}  // namespace
}  // namespace trivet::kernels

#include "engine/common/describe_surface.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "engine/common/thread_limit.hpp"
#include "support/random.hpp"
#include "support/sampled_shape.hpp"
#include "support/shapes.hpp"

namespace trivet::engine {
namespace {

constexpr float kRadius = 0.5F;

/// An irregular body without symmetry.
test::SampledShape lumps() {
  test::Shape shape = test::ellipsoid({1, 0.7F, 0.5F}, 40);
  shape.join(
      test::ellipsoid({0.4F, 0.3F, 0.5F}, 30).moved(Pose(Eigen::Translation3f(0.7F, 0.3F, 0.4F))));
  shape.join(test::ellipsoid({0.3F, 0.4F, 0.2F}, 30)
                 .moved(Pose(Eigen::Translation3f(-0.5F, -0.5F, 0.2F))));
  return test::sample_shape(shape.vertices, shape.triangles, 1, 6000);
}

std::vector<std::uint32_t> every(std::size_t step, std::size_t n) {
  std::vector<std::uint32_t> indices;
  for (std::size_t i = 0; i < n; i += step) indices.push_back(static_cast<std::uint32_t>(i));
  return indices;
}

Descriptions describe(PointsView points, NormalsView normals, std::size_t step = 10,
                      float radius = kRadius) {
  Descriptions out;
  describe_surface(points, normals, every(step, points.size()), radius, {}, out);
  return out;
}

std::span<const float> image(const Descriptions& all, std::size_t i) {
  return std::span(all.images).subspan(i * kernels::kTriSpinSize, kernels::kTriSpinSize);
}
double distance(std::span<const float> a, std::span<const float> b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += std::pow(a[k] - b[k], 2);
  return std::sqrt(sum);
}

// The property that turns a match into a pose: the same keypoint of a moved body has the same
// image, and the two frames give the motion.
TEST(DescribeSurface, GivesTheMotionOfABodyByOneMatch) {
  const test::SampledShape body = lumps();
  test::Random random;
  const Pose motion = random.motion();
  const Points moved = test::transformed(body.points, motion.linear(), motion.translation());
  const Normals turned = test::transformed(body.normals, motion.linear(), Eigen::Vector3f::Zero());
  const Descriptions here = describe(body.points, body.normals), there = describe(moved, turned);
  ASSERT_GT(here.size(), 300U);
  ASSERT_NEAR(static_cast<double>(here.size()), static_cast<double>(there.size()), 5);
  std::size_t matched = 0;
  for (std::size_t i = 0; i < here.size(); ++i) {
    const Eigen::Vector3f image_of = motion * here.keypoints[i];
    for (std::size_t k = 0; k < there.size(); ++k) {
      if ((there.keypoints[k] - image_of).norm() > 1e-4F) continue;
      EXPECT_LT(distance(image(here, i), image(there, k)), 0.1) << i;
      const Eigen::Matrix3f turn = there.frames[k].transpose() * here.frames[i];
      matched += (turn - motion.linear()).norm() < 0.02F;
    }
  }
  EXPECT_GT(matched, here.size() * 95 / 100);
}

TEST(DescribeSurface, DistinguishesPlaces) {
  const test::SampledShape body = lumps();
  const Descriptions all = describe(body.points, body.normals);
  double nearest_far = 10;
  for (std::size_t i = 0; i < all.size(); i += 7) {
    for (std::size_t k = 0; k < all.size(); ++k) {
      if ((all.keypoints[i] - all.keypoints[k]).norm() > kRadius)
        nearest_far = std::min(nearest_far, distance(image(all, i), image(all, k)));
    }
  }
  EXPECT_GT(nearest_far, 0.1);
}

TEST(DescribeSurface, LeavesOutBordersWhereItIsAsked) {
  test::Random random;
  Points points;
  Normals normals;
  for (int k = 0; k < 6000; ++k) {
    const float x = random.uniform(-1, 1), y = random.uniform(-1, 1);
    points.push_back({x, y, 0.2F * std::sin(7 * x) * std::cos(5 * y)});
    normals.push_back({0, 0, 1});
  }
  const auto keypoints = every(20, points.size());
  const auto describe = [&](float max_lean) {
    Descriptions out;
    const auto kept =
        describe_surface(points, normals, keypoints, 0.3F, {.max_lean = max_lean}, out);
    std::size_t at_border = 0;
    for (const std::uint32_t k : kept) {
      const Eigen::Vector3f p = points[keypoints[k]];
      at_border += std::max(std::abs(p.x()), std::abs(p.y())) > 0.97F;
    }
    return std::pair(kept.size(), at_border);
  };
  const auto [all, borders] = describe(1);
  const auto [inner, few] = describe(0.15F);
  EXPECT_GT(borders, 5U);
  EXPECT_EQ(few, 0U);
  EXPECT_GT(inner, all / 2);
}

TEST(DescribeSurface, LeavesOutWhatHoldsNoFrameAndAppends) {
  test::Random random;
  Points points;
  Normals normals;
  for (int k = 0; k < 3000; ++k) {  // a disc: at its center any rotation about its normal fits
    const float a = random.uniform(0, 6.2831853F), r = std::sqrt(random.uniform(0, 1));
    points.push_back({r * std::cos(a), r * std::sin(a), 0});
    normals.push_back({0, 0, 1});
  }
  points.set(0, {0, 0, 0});
  Descriptions out;
  const std::vector<std::uint32_t> middle{0};
  describe_surface(points, normals, middle, 0.8F, {.min_hold = 0.2F}, out);
  EXPECT_EQ(out.size(), 0U);
  EXPECT_TRUE(out.images.empty());
  normals.set(0, Eigen::Vector3f::Constant(std::nanf("")));
  describe_surface(points, normals, middle, 0.8F, {.min_hold = 0}, out);
  EXPECT_EQ(out.size(), 0U) << "no normal";
  const test::SampledShape body = lumps();
  const auto keypoints = every(100, body.points.size());
  describe_surface(body.points, body.normals, keypoints, kRadius, {}, out);
  const std::size_t first = out.size();
  describe_surface(body.points, body.normals, keypoints, kRadius, {}, out);
  ASSERT_EQ(out.size(), 2 * first);
  EXPECT_EQ(distance(image(out, 3), image(out, first + 3)), 0);
  EXPECT_EQ(out.images.size(), out.size() * kernels::kTriSpinSize);
}

TEST(DescribeSurface, GivesTheSameBytesForAnyNumberOfThreads) {
  const test::SampledShape body = lumps();
  const auto with_threads = [&](unsigned n) {
    const ThreadLimit limit(n);
    return describe(body.points, body.normals);
  };
  const Descriptions one = with_threads(1), two = with_threads(2);
  EXPECT_TRUE(test::same_bits(one.images, two.images));
  EXPECT_TRUE(test::same_bits(one.keypoints, two.keypoints));
}

}  // namespace
}  // namespace trivet::engine

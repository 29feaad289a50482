#include "kernels/symmetry/find_difference.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "kernels/common/pose_math.hpp"
#include "support/random.hpp"
#include "support/sampled_shape.hpp"
#include "support/shapes.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

/// A plate, with a post of some height on it, in millimeters.
test::SampledShape plate_with_post(float height, std::uint64_t seed, const Pose& at) {
  test::Shape shape = test::box({-50, -30, 0}, {50, 30, 10});
  if (height > 0) shape.join(test::box({20, 5, 10}, {30, 15, 10 + height}));
  shape = shape.moved(at);
  return test::sample_shape(shape.vertices, shape.triangles, seed);
}

/// The definition, in double.
double reference_distance(const ModelSamples& surface, const Vector3d& point,
                          const Vector3d& facing) {
  const double radius = 1.5 * static_cast<double>(surface.spacing);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < surface.points.size(); ++k) {
    const Vector3d d = point - surface.points[k].cast<double>();
    const Vector3d normal = Vector3f(surface.normals[k]).cast<double>();
    const double height = d.dot(normal), along = (d - height * normal).norm();
    const bool faces_alike = normal.dot(facing) > 0.5;
    least =
        std::min(least, faces_alike ? std::hypot(height, std::max(along - radius, 0.0)) : d.norm());
  }
  return least;
}

TEST(SurfaceDistances, AgreeWithTheReference) {
  test::Random random;
  test::SampledShape surface = plate_with_post(20, 1, Pose::Identity());
  for (const std::size_t n :
       {std::size_t{1}, std::size_t{15}, std::size_t{16}, std::size_t{17}, surface.points.size()}) {
    test::SampledShape part = surface;
    part.points.resize(n);
    part.normals.resize(n);
    Points points;
    Normals normals;
    for (int i = 0; i < 50; ++i) {
      points.push_back({random.uniform(-80, 80), random.uniform(-50, 50), random.uniform(-20, 50)});
      normals.push_back(random.direction());
    }
    std::vector<float> distances(points.size());
    surface_distances(part.view(), points, normals, distances);
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_NEAR(distances[i],
                  reference_distance(part.view(), points[i].cast<double>(),
                                     Vector3f(normals[i]).cast<double>()),
                  1e-2)
          << n << " samples, point " << i;
    }
  }
}

TEST(FindDifference, IsNothingForTwoSamplingsOfOneSurface) {
  const test::SampledShape first = plate_with_post(20, 1, Pose::Identity()),
                           second = plate_with_post(20, 2, Pose::Identity());
  EXPECT_LT(find_difference(first.view(), second.view(), Pose::Identity()).deviation,
            first.spacing);
}

TEST(FindDifference, ReportsWhereThePostsEndsAreWhateverTheFrameOfTheSecond) {
  const Pose at = small_motion({0.3F, -1.2F, 0.8F}, {500, 100, -70}, Vector3f::Zero());
  const test::SampledShape longer = plate_with_post(20, 1, Pose::Identity()),
                           shorter = plate_with_post(12, 2, at);
  const SurfaceDifference found = find_difference(longer.view(), shorter.view(), at.inverse());
  EXPECT_NEAR(found.deviation, 8, 0.2F);
  EXPECT_LT((found.center - Vector3f(25, 10, 28)).norm(), 3) << found.center.transpose();
  EXPECT_GT(found.size, 9);
  EXPECT_LT(found.size, 20);
  EXPECT_NEAR(found.look_from.norm(), 1, 1e-4F);
  EXPECT_GT(found.look_from.z(), 0.5F) << "from above";
}

TEST(FindDifference, IsSeenFromTheSideThatItLiesOn) {
  const Pose under = small_motion({3.14159265F, 0, 0}, Vector3f::Zero(), Vector3f::Zero());
  const test::SampledShape plain = plate_with_post(0, 1, under),
                           post = plate_with_post(15, 2, under);
  EXPECT_LT(find_difference(plain.view(), post.view(), Pose::Identity()).look_from.z(), -0.5F);
  EXPECT_LT(find_difference(post.view(), plain.view(), Pose::Identity()).look_from.z(), -0.5F);
}

TEST(FindDifference, KeepsToTheRegionOfTheLargestDeviation) {
  test::Shape two = test::box({-50, -30, 0}, {50, 30, 10});
  two.join(test::box({20, 5, 10}, {30, 15, 26})).join(test::box({-40, -20, 10}, {-30, -10, 22}));
  const test::SampledShape plain = plate_with_post(0, 1, Pose::Identity()),
                           posts = test::sample_shape(two.vertices, two.triangles, 2);
  const SurfaceDifference found = find_difference(plain.view(), posts.view(), Pose::Identity());
  EXPECT_NEAR(found.deviation, 16, 0.2F);
  EXPECT_LT((found.center - Vector3f(25, 10, 23)).norm(), 5) << found.center.transpose();
}

}  // namespace
}  // namespace trivet::kernels

#include "kernels/surfaces/solid_angles.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "support/rendered_scene.hpp"
#include "support/shapes.hpp"

namespace trivet {
namespace {

using Eigen::Vector3d;
using kernels::SolidAngles;
using std::numbers::pi;

SolidAngles angles_of(const test::Shape& shape, const Vector3d& eye) {
  return kernels::sum_solid_angles(shape.vertices, shape.triangles, eye, 0, shape.triangles.size());
}

/// The solid angles by summing cos / r^2 over 400 x 400 parts of each triangle.
SolidAngles naive(const test::Shape& shape, const Vector3d& eye) {
  constexpr int kParts = 400;
  SolidAngles sums;
  for (std::size_t t = 0; t < shape.triangles.size(); ++t) {
    const Vector3d a = shape.vertices[shape.triangles.a[t]].cast<double>(),
                   u = shape.vertices[shape.triangles.b[t]].cast<double>() - a,
                   v = shape.vertices[shape.triangles.c[t]].cast<double>() - a;
    const Vector3d part = u.cross(v) / 2 / (kParts * kParts);
    for (int i = 0; i < kParts; ++i) {
      for (int j = 0; j < kParts - i; ++j) {
        for (const double third : {1.0 / 3, 2.0 / 3}) {
          if (third > 0.5 && j == kParts - i - 1) continue;
          const Vector3d p = a + (i + third) / kParts * u + (j + third) / kParts * v - eye;
          const double angle = -part.dot(p) / (p.squaredNorm() * p.norm());
          (angle > 0 ? sums.front : sums.back) += std::abs(angle);
        }
      }
    }
  }
  return sums;
}

TEST(SumSolidAngles, AgreesWithASumOverSmallParts) {
  const test::Shape box = test::box({-0.5F, -0.2F, 0}, {0.4F, 0.3F, 0.7F});
  for (const Vector3d& eye : {Vector3d(1, 2, 3), Vector3d(-0.8, 0.1, 0.2), Vector3d(0, 0, 0.4)}) {
    const SolidAngles angles = angles_of(box, eye), expected = naive(box, eye);
    EXPECT_NEAR(angles.front, expected.front, 1e-4);
    EXPECT_NEAR(angles.back, expected.back, 1e-4);
  }
}

TEST(SumSolidAngles, OfAClosedSurfaceAreEqualFromOutsideAndAllAroundFromInside) {
  const test::Shape bracket = test::bracket();
  const SolidAngles outside = angles_of(test::box({0, 0, 0}, {1, 1, 1}), {3, -2, 1.5});
  EXPECT_GT(outside.front, 0.05);
  EXPECT_NEAR(outside.front, outside.back, 1e-9);
  const SolidAngles inside = angles_of(test::box({0, 0, 0}, {1, 1, 1}), {0.5, 0.4, 0.6});
  EXPECT_NEAR(inside.back, 4 * pi, 1e-9);
  EXPECT_EQ(inside.front, 0);
  const SolidAngles far = angles_of(bracket, {0, 0, 1e4});
  EXPECT_NEAR(far.front / far.back, 1, 1e-3) << "far away";
}

TEST(SumSolidAngles, DoNotChangeWithAMotion) {
  const test::Shape lever = test::lever();
  const Pose motion = test::pose_of({0.7F, -1.2F, 2}, {0.3F, -0.2F, 0.5F});
  const Vector3d eye(0.1, 0.2, -0.7);
  const SolidAngles here = angles_of(lever, eye);
  const SolidAngles there =
      angles_of(test::Shape(lever).moved(motion), motion.cast<double>() * eye);
  EXPECT_NEAR(there.front, here.front, 1e-5);
  EXPECT_NEAR(there.back, here.back, 1e-5);
}

TEST(SumSolidAngles, CountsNothingForATriangleAroundTheEyeOrWithoutArea) {
  test::Shape flat;
  for (const Eigen::Vector3f& p :
       {Eigen::Vector3f(-1, -1, 0), Eigen::Vector3f(1, -1, 0), Eigen::Vector3f(0, 1, 0)})
    flat.vertices.push_back(p);
  flat.triangles.push_back(0, 1, 2);
  flat.triangles.push_back(0, 1, 1);
  for (const Vector3d& eye : {Vector3d(0, 0, 0), Vector3d(-1, -1, 0), Vector3d(5, 0, 0)}) {
    EXPECT_EQ(angles_of(flat, eye).front, 0);
    EXPECT_EQ(angles_of(flat, eye).back, 0);
  }
}

}  // namespace
}  // namespace trivet

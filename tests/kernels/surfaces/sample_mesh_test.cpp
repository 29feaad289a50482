#include "kernels/surfaces/sample_mesh.hpp"

#include <gtest/gtest.h>

#include "support/allocations.hpp"
#include "support/random.hpp"
#include "support/reference_model.hpp"
#include "support/shapes.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3d;
using test::Random;
using test::Shape;

struct Samples {
  Points points;
  Normals normals;
};

Samples sample(const Shape& shape, std::size_t n, std::uint64_t seed = 1, std::size_t grain = 0) {
  std::vector<double> sums(shape.triangles.size());
  sum_areas(shape.vertices, shape.triangles, sums);
  Samples out{Points(n), Normals(n)};
  test::for_chunks(n, grain == 0 ? n : grain, [&](std::size_t first, std::size_t count) {
    sample_mesh({shape.vertices, shape.triangles, sums}, seed, first, n,
                {out.points.span().slice(first, count), out.normals.span().slice(first, count)});
  });
  return out;
}

/// Barycentric coordinates of a point's foot on the triangle, and its distance from the plane.
struct Foot {
  double u, v, height;
};
Foot foot(const Shape& shape, std::size_t t, const Eigen::Vector3f& point) {
  const Vector3d a = reference::corner(shape.vertices, shape.triangles.a, t);
  const Vector3d b = reference::corner(shape.vertices, shape.triangles.b, t);
  const Vector3d c = reference::corner(shape.vertices, shape.triangles.c, t);
  Eigen::Matrix3d system;
  system << b - a, c - a, (b - a).cross(c - a).normalized();
  const Vector3d uvh = system.inverse() * (point.cast<double>() - a);
  return {uvh.x(), uvh.y(), uvh.z()};
}

/// Triangles without overlap: stacked, of very different sizes, some without area.
Shape stack(Random& random, std::size_t n) {
  Shape shape;
  for (std::size_t t = 0; t < n; ++t) {
    const float z = static_cast<float>(t), size = std::exp(random.uniform(-2, 2));
    const Eigen::Vector3f a(0, 0, z), b(size, 0, z), c(random.uniform(0, 1), size, z);
    if (t % 4 == 0)
      shape.add(a, b, 0.5F * (a + b));
    else
      shape.add(a, b, c);
  }
  return shape;
}

TEST(SumAreas, AddsUpTheFacesOfABox) {
  const Shape box = test::box({0, 0, 0}, {1, 2, 3});
  std::vector<double> sums(box.triangles.size());
  EXPECT_EQ(sum_areas(box.vertices, box.triangles, sums), 22);
  EXPECT_EQ(sums.back(), 22);
  EXPECT_TRUE(std::ranges::is_sorted(sums));
}

TEST(SumAreas, OfNoTrianglesIsZero) { EXPECT_EQ(sum_areas(PointsView{}, Triangles{}, {}), 0); }

TEST(SampleMesh, GivesEachTriangleItsShareAndLeavesOutThoseWithoutArea) {
  for (const std::size_t num_triangles : {2, 3, 9, 64}) {
    Random random(num_triangles);
    const Shape shape = stack(random, num_triangles);
    std::vector<double> sums(num_triangles);
    const double area = sum_areas(shape.vertices, shape.triangles, sums);
    for (const std::size_t n : {1, 2, 7, 500}) {
      const Samples samples = sample(shape, n);
      std::vector<int> counts(num_triangles);
      for (std::size_t i = 0; i < n; ++i) {
        ++counts[static_cast<std::size_t>(std::lround(samples.points[i].z()))];
      }
      for (std::size_t t = 0; t < num_triangles; ++t) {
        const double share = (sums[t] - (t == 0 ? 0 : sums[t - 1])) / area * static_cast<double>(n);
        if (share == 0) {
          EXPECT_EQ(counts[t], 0);
        }
        EXPECT_NEAR(counts[t], share, 2) << "triangle " << t << " of " << num_triangles;
      }
    }
  }
}

TEST(SampleMesh, PutsSamplesOnTheirTrianglesWithTheirNormals) {
  Random random;
  const Shape shape = stack(random, 20);
  const Samples samples = sample(shape, 1000);
  for (std::size_t i = 0; i < 1000; ++i) {
    const auto t = static_cast<std::size_t>(std::lround(samples.points[i].z()));
    const Foot at = foot(shape, t, samples.points[i]);
    EXPECT_GE(at.u, -1e-5);
    EXPECT_GE(at.v, -1e-5);
    EXPECT_LE(at.u + at.v, 1 + 1e-5);
    EXPECT_NEAR(at.height, 0, 1e-6);
    EXPECT_EQ(samples.normals[i], Eigen::Vector3f::UnitZ());
  }
}

// 1600 samples on 16 equal parts of one triangle: random sampling would deviate by 10 (one sigma).
TEST(SampleMesh, CoversATriangleMoreEvenlyThanChance) {
  Shape shape;
  shape.add({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  const Samples samples = sample(shape, 1600);
  std::array<int, 16> counts{};
  for (std::size_t i = 0; i < 1600; ++i) {
    const double x = 4 * samples.points[i].x(), y = 4 * samples.points[i].y();
    const int column = static_cast<int>(x), row = static_cast<int>(y);
    const bool upper = x - column + y - row > 1;
    // Rows of 7, 5, 3 and 1 parts.
    const int first = 8 * row - row * row;
    ++counts[static_cast<std::size_t>(std::min(15, first + 2 * column + (upper ? 1 : 0)))];
  }
  for (const int count : counts) EXPECT_NEAR(count, 100, 8);
}

TEST(SampleMesh, GivesTheSameBitsForAnyChunking) {
  Random random;
  const Shape shape = stack(random, 30);
  const Samples whole = sample(shape, 257);
  for (const std::size_t grain : {1, 64, 256}) {
    const Samples split = sample(shape, 257, 1, grain);
    EXPECT_TRUE(test::same_bits(whole.points, split.points));
    EXPECT_TRUE(test::same_bits(whole.normals, split.normals));
  }
}

TEST(SampleMesh, GivesOtherSamplesForAnotherSeed) {
  const Shape shape = test::tetrahedron();
  EXPECT_FALSE(test::same_bits(sample(shape, 100, 1).points, sample(shape, 100, 2).points));
}

TEST(SampleMesh, AllocatesNothing) {
  const Shape shape = test::tetrahedron();
  std::vector<double> sums(shape.triangles.size());
  Samples out{Points(100), Normals(100)};
  EXPECT_EQ(
      test::allocations_in([&] {
        sum_areas(shape.vertices, shape.triangles, sums);
        sample_mesh({shape.vertices, shape.triangles, sums}, 1, 0, 100, {out.points, out.normals});
      }),
      0U);
}

}  // namespace
}  // namespace trivet::kernels

#include "kernels/surfaces/mesh_resolution.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <map>

#include "support/random.hpp"
#include "support/shapes.hpp"

namespace trivet::kernels {
namespace {

/// A sheet of 3 x 2 unit squares, each of two triangles, with shared edges.
test::Shape sheet() {
  test::Shape shape;
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 4; ++x)
      shape.vertices.push_back({static_cast<float>(x), static_cast<float>(y), 0});
  for (std::uint32_t y = 0; y < 2; ++y) {
    for (std::uint32_t x = 0; x < 3; ++x) {
      const std::uint32_t corner = 4 * y + x;
      shape.triangles.push_back(corner, corner + 1, corner + 5);
      shape.triangles.push_back(corner, corner + 5, corner + 4);
    }
  }
  return shape;
}

TEST(MeanEdgeLength, CountsEachEdgeOnce) {
  const test::Shape shape = sheet();
  // 3 rows of 3, 4 columns of 2, and 6 diagonals.
  EXPECT_DOUBLE_EQ(mean_edge_length(shape.vertices, shape.triangles),
                   (17 + 6 * std::sqrt(2.0)) / 23);
  EXPECT_EQ(mean_edge_length(shape.vertices, {}), 0);
}

TEST(MeanEdgeLength, AgreesWithReferenceOnRandomTriangles) {
  test::Random random;
  const Points vertices = random.dyadic_cloud(50);
  Triangles triangles;
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> edges;
  for (int t = 0; t < 300; ++t) {
    const std::array<std::uint32_t, 3> corners{random.below(50), random.below(50),
                                               random.below(50)};
    triangles.push_back(corners[0], corners[1], corners[2]);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [i, j] = std::minmax(corners[k], corners[(k + 1) % 3]);
      edges[{i, j}] = (vertices[i].cast<double>() - vertices[j].cast<double>()).norm();
    }
  }
  double sum = 0;
  for (const auto& [edge, length] : edges) sum += length;
  const double expected = sum / static_cast<double>(edges.size());
  EXPECT_NEAR(mean_edge_length(vertices, triangles), expected, 1e-12 * expected);
}

TEST(MeanNeighborDistance, IsTheSpacingOfALattice) {
  Points points;
  for (int i = 0; i < 125; ++i) {
    points.push_back(0.25F * Eigen::Vector3f(static_cast<float>(i % 5),
                                             static_cast<float>(i / 5 % 5),
                                             static_cast<float>(i / 25)));
  }
  EXPECT_EQ(*mean_neighbor_distance(points), 0.25);
}

TEST(MeanNeighborDistance, AgreesWithReferenceOnRandomPoints) {
  for (const std::size_t n : {2U, 3U, 64U, 500U}) {
    const Points points = test::Random(n).surface(n);
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) {
      double nearest = std::numeric_limits<double>::infinity();
      for (std::size_t j = 0; j < n; ++j)
        if (j != i)
          nearest = std::min(nearest, (points[i].cast<double>() - points[j].cast<double>()).norm());
      sum += nearest;
    }
    // The tree's squared distances are floats: a few operations with a rounding of half of 2^-23
    // each.
    const double expected = sum / static_cast<double>(n);
    EXPECT_NEAR(*mean_neighbor_distance(points), expected, 1e-6 * expected);
  }
}

TEST(MeanNeighborDistance, AcceptsFewAndRefusesBrokenPoints) {
  EXPECT_EQ(*mean_neighbor_distance(Points()), 0);
  EXPECT_EQ(*mean_neighbor_distance(Points(1)), 0);
  EXPECT_EQ(*mean_neighbor_distance(Points(2)), 0) << "in one place";
  Points points(2);
  points.set(1, {0, std::numeric_limits<float>::quiet_NaN(), 0});
  EXPECT_FALSE(mean_neighbor_distance(points));
}

}  // namespace
}  // namespace trivet::kernels

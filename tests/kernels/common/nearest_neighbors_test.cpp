#include "kernels/common/nearest_neighbors.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numeric>

#include "support/random.hpp"
#include "support/reference.hpp"

namespace trivet::kernels {
namespace {

using test::Random;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

NearestNeighbors build(PointsView points) {
  auto built = NearestNeighbors::build(points);
  EXPECT_TRUE(built.has_value());
  return std::move(built).value();
}

struct Found {
  std::vector<std::uint32_t> indices;
  std::vector<float> squared_distances;
};

Found k_nearest(const NearestNeighbors& tree, PointsView queries, std::size_t k) {
  Found out{std::vector<std::uint32_t>(queries.size() * k), std::vector<float>(queries.size() * k)};
  EXPECT_TRUE(tree.k_nearest(queries, k, out.indices, out.squared_distances).has_value());
  return out;
}

void expect_reference_neighbors(PointsView points, PointsView queries, std::size_t k) {
  const Found found = k_nearest(build(points), queries, k);
  for (std::size_t q = 0; q < queries.size(); ++q) {
    auto expected = reference::nearest(points, queries[q], k);
    for (std::size_t j = 0; j < k; ++j) {
      const bool exists = j < expected.size();
      ASSERT_EQ(found.indices[q * k + j], exists ? expected[j] : NearestNeighbors::kNone)
          << "query " << q << " neighbor " << j;
      ASSERT_EQ(found.squared_distances[q * k + j],
                exists ? reference::squared_distance(points[expected[j]], queries[q]) : kInfinity);
    }
  }
}

TEST(NearestNeighbors, AgreesWithReferenceOnRandomClouds) {
  for (const std::size_t n : test::kSmallSizes) {
    Random random(n);
    const Points points = random.dyadic_cloud(n), queries = random.dyadic_cloud(50, 4);
    for (const std::size_t k : {1U, 5U, 40U}) expect_reference_neighbors(points, queries, k);
  }
}

TEST(NearestNeighbors, BreaksTiesOnALatticeByTheLowestIndex) {
  Points lattice, centers;
  for (const std::uint32_t i : Random().permutation(216)) {
    const Eigen::Vector3f p(static_cast<float>(i % 6), static_cast<float>(i / 6 % 6),
                            static_cast<float>(i / 36));
    lattice.push_back(p);
    lattice.push_back(p);  // every point twice
    centers.push_back(p + Eigen::Vector3f::Constant(0.5F));
  }
  for (const std::size_t k : {1U, 3U, 10U}) {
    expect_reference_neighbors(lattice, centers, k);
    expect_reference_neighbors(lattice, lattice, k);
  }
}

TEST(NearestNeighbors, SearchesFeatureVectorsOfAnyDimension) {
  Random random;
  constexpr std::size_t kDimension = 30, kNumVectors = 300;
  std::vector<float> vectors(kDimension * kNumVectors);
  for (float& v : vectors) v = static_cast<float>(random.below(16));  // integers: exact distances
  const auto tree = NearestNeighbors::build(vectors, kDimension);
  ASSERT_TRUE(tree.has_value());
  EXPECT_EQ(tree->size(), kNumVectors);
  EXPECT_EQ(tree->dimension(), kDimension);
  std::vector<std::uint32_t> indices(2 * kNumVectors);
  std::vector<float> distances(2 * kNumVectors);
  ASSERT_TRUE(tree->k_nearest(vectors, 2, indices, distances).has_value());
  for (std::size_t q = 0; q < kNumVectors; ++q) {
    std::vector<std::pair<float, std::uint32_t>> all;
    for (std::uint32_t i = 0; i < kNumVectors; ++i) {
      float sum = 0;
      for (std::size_t d = 0; d < kDimension; ++d) {
        const float difference = vectors[q * kDimension + d] - vectors[i * kDimension + d];
        sum += difference * difference;
      }
      all.emplace_back(sum, i);
    }
    std::ranges::sort(all);
    EXPECT_EQ(indices[2 * q], q);
    EXPECT_EQ(indices[2 * q + 1], all[1].second);
    EXPECT_EQ(distances[2 * q + 1], all[1].first);
  }
}

TEST(NearestNeighbors, CountsAndFillsWhatLiesWithinARadius) {
  Random random;
  const Points points = random.dyadic_cloud(300);
  const NearestNeighbors tree = build(points);
  std::vector<float> queries;
  for (std::size_t i = 0; i < points.size(); ++i) {
    queries.insert(queries.end(), {points[i].x(), points[i].y(), points[i].z()});
  }
  for (const float radius : {-1.0F, 0.0F, 0.5F, 1.25F, 10.0F}) {
    std::vector<std::uint32_t> offsets(points.size() + 1, 0);
    ASSERT_TRUE(tree.count_within(queries, radius, std::span(offsets).subspan(1)).has_value());
    std::inclusive_scan(offsets.begin(), offsets.end(), offsets.begin());
    std::vector<std::uint32_t> indices(offsets.back());
    ASSERT_TRUE(tree.fill_within(queries, radius, offsets, indices).has_value());
    for (std::size_t q = 0; q < points.size(); ++q) {
      const std::vector<std::uint32_t> found(indices.begin() + offsets[q],
                                             indices.begin() + offsets[q + 1]);
      if (radius < 0) {
        ASSERT_TRUE(found.empty());
      } else {
        ASSERT_EQ(found, reference::within(points, points[q], radius)) << "radius " << radius;
      }
    }
  }
}

TEST(NearestNeighbors, GivesTheSameBitsForAnyChunking) {
  Random random;
  const Points points = random.surface(300), queries = random.surface(100);
  const NearestNeighbors tree = build(points);
  const Found whole = k_nearest(tree, queries, 3);
  for (const std::size_t grain : {1U, 7U, 64U}) {
    test::for_chunks(100, grain, [&](std::size_t first, std::size_t count) {
      const Found chunk = k_nearest(tree, queries.view().slice(first, count), 3);
      EXPECT_TRUE(std::equal(chunk.indices.begin(), chunk.indices.end(),
                             whole.indices.begin() + static_cast<std::ptrdiff_t>(3 * first)));
    });
  }
}

TEST(NearestNeighbors, FindsNothingForAQueryThatIsNotFinite) {
  Points points(3), queries;
  queries.push_back({0, std::nanf(""), 0});
  queries.push_back({kInfinity, 0, 0});
  const Found found = k_nearest(build(points), queries, 1);
  EXPECT_EQ(found.indices, std::vector(2, NearestNeighbors::kNone));
}

TEST(NearestNeighbors, RefusesDataThatIsNotFiniteAndSaysWhere) {
  Points points(3);
  points.set(2, {0, 0, std::nanf("")});
  const auto built = NearestNeighbors::build(points);
  ASSERT_FALSE(built.has_value());
  EXPECT_EQ(built.error().code, ErrorCode::bad_data);
  EXPECT_NE(built.error().message.find("vector 2, component 2"), std::string::npos)
      << built.error().message;
}

TEST(NearestNeighbors, RefusesPartsOfVectors) {
  const std::vector<float> values(7);
  EXPECT_FALSE(NearestNeighbors::build(values, 3).has_value());
  EXPECT_FALSE(NearestNeighbors::build(values, 0).has_value());
}

}  // namespace
}  // namespace trivet::kernels

#include "kernels/spin_images/feature_forest.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "kernels/common/nearest_neighbors.hpp"
#include "support/allocations.hpp"
#include "support/random.hpp"

namespace trivet::kernels {
namespace {

/// Vectors in clusters, as features are.
std::vector<float> clustered(test::Random& random, std::size_t n, std::size_t dimension,
                             std::size_t num_clusters = 40) {
  std::vector<float> centers(num_clusters * dimension), vectors;
  for (float& value : centers) value = random.normal(1);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t c = random.below(static_cast<std::uint32_t>(num_clusters));
    for (std::size_t k = 0; k < dimension; ++k)
      vectors.push_back(centers[c * dimension + k] + random.normal(0.2F));
  }
  return vectors;
}

struct Found {
  std::vector<std::uint32_t> indices;
  std::vector<float> distances;
};
Found search(const FeatureForest& forest, std::span<const float> queries, std::size_t k,
             std::size_t checks) {
  const std::size_t m = queries.size() / forest.dimension();
  Found found{std::vector<std::uint32_t>(m * k), std::vector<float>(m * k)};
  FeatureForest::Scratch scratch;
  forest.k_nearest(queries, k, checks, found.indices, found.distances, scratch);
  return found;
}
Found exact(std::span<const float> vectors, std::size_t dimension, std::span<const float> queries,
            std::size_t k) {
  const std::size_t m = queries.size() / dimension;
  Found found{std::vector<std::uint32_t>(m * k), std::vector<float>(m * k)};
  const auto tree = NearestNeighbors::build(vectors, dimension);
  EXPECT_TRUE(tree && tree->k_nearest(queries, k, found.indices, found.distances));
  return found;
}

TEST(FeatureForest, IsExactWhenEveryVectorMayBeCompared) {
  for (const std::size_t n : test::kSmallSizes) {
    for (const std::size_t dimension : {1U, 3U, 17U, 60U}) {
      test::Random random(100 * n + dimension);
      const auto vectors = clustered(random, n, dimension),
                 queries = clustered(random, 20, dimension);
      for (const std::uint32_t trees : {1U, 4U}) {
        const FeatureForest forest(vectors, dimension, trees);
        EXPECT_EQ(forest.size(), n);
        const Found found = search(forest, queries, 3, trees * n + 1);
        const Found expected = exact(vectors, dimension, queries, 3);
        EXPECT_EQ(found.indices, expected.indices) << n << ' ' << dimension;
        for (std::size_t i = 0; i < found.distances.size(); ++i) {
          if (found.indices[i] == FeatureForest::kNone) {
            EXPECT_EQ(found.distances[i], std::numeric_limits<float>::infinity());
          } else {
            EXPECT_NEAR(found.distances[i], expected.distances[i],
                        1e-4F * (1 + expected.distances[i]));
          }
        }
      }
    }
  }
}

TEST(FeatureForest, FindsMostNeighborsAtATinyShareOfTheComparisons) {
  test::Random random;
  const auto vectors = clustered(random, 20000, 60, 400);
  std::vector<float> queries(vectors.begin(), vectors.begin() + 200 * 60);
  for (float& value : queries) value += random.normal(0.1F);
  const FeatureForest forest(vectors, 60);
  const Found expected = exact(vectors, 60, queries, 1);
  const auto share = [&](std::size_t checks) {
    const Found found = search(forest, queries, 1, checks);
    std::size_t right = 0;
    for (std::size_t i = 0; i < 200; ++i) right += found.indices[i] == expected.indices[i];
    return static_cast<double>(right) / 200;
  };
  EXPECT_GT(share(400), 0.9);
  EXPECT_GT(share(100), 0.6);
}

TEST(FeatureForest, FindsAVectorThatItHolds) {
  test::Random random;
  const auto vectors = clustered(random, 5000, 60);
  const FeatureForest forest(vectors, 60);
  const Found found = search(forest, std::span(vectors).first(300 * 60), 2, 64);
  for (std::uint32_t i = 0; i < 300; ++i) {
    EXPECT_EQ(found.indices[2 * i], i);
    EXPECT_EQ(found.distances[2 * i], 0);
    EXPECT_NE(found.indices[2 * i + 1], i) << "found by another tree again";
  }
}

TEST(FeatureForest, TakesTheLowestIndexOfEqualVectorsAndHoldsManyOfThem) {
  std::vector<float> same(200 * 4, 1.5F);
  const FeatureForest forest(same, 4);
  const Found found = search(forest, std::span(same).first(4), 3, 1000);
  EXPECT_EQ(found.indices, (std::vector<std::uint32_t>{0, 1, 2}));
}

TEST(FeatureForest, GivesTheSameBitsForAnyChunkingAndEachTimeItIsBuilt) {
  test::Random random;
  const auto vectors = clustered(random, 3000, 60), queries = clustered(random, 50, 60);
  const FeatureForest forest(vectors, 60), again(vectors, 60);
  const Found whole = search(forest, queries, 3, 100);
  EXPECT_EQ(search(again, queries, 3, 100).indices, whole.indices);
  FeatureForest::Scratch scratch;
  Found parts{std::vector<std::uint32_t>(150), std::vector<float>(150)};
  test::for_chunks(50, 7, [&](std::size_t first, std::size_t count) {
    forest.k_nearest(std::span(std::as_const(queries)).subspan(first * 60, count * 60), 3, 100,
                     std::span(parts.indices).subspan(first * 3, count * 3),
                     std::span(parts.distances).subspan(first * 3, count * 3), scratch);
  });
  EXPECT_EQ(parts.indices, whole.indices);
  EXPECT_TRUE(test::same_bits(parts.distances, whole.distances));
  EXPECT_EQ(test::allocations_in([&] {
              forest.k_nearest(std::span(std::as_const(queries)).first(60), 3, 100,
                               std::span(parts.indices).first(3),
                               std::span(parts.distances).first(3), scratch);
            }),
            0U);
}

TEST(FeatureForest, HoldsNothing) {
  const FeatureForest none({}, 60);
  const std::vector<float> query(60);
  const Found found = search(none, query, 2, 10);
  EXPECT_EQ(found.indices, (std::vector<std::uint32_t>(2, FeatureForest::kNone)));
}

}  // namespace
}  // namespace trivet::kernels

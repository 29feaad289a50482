#include "descriptors/feature_pool.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/common/parallel.hpp"
#include "storage/common/simd.hpp"

namespace trivet::bench {
namespace {

constexpr std::size_t kLanes = 16;
constexpr std::size_t kQueriesAtOnce = 32, kFeaturesAtOnce = 128;  // a block stays in the L2 cache

/// Sixteen partial sums, added in the same order on any processor; the remainder one by one.
TRIVET_SIMD_CLONES
void compare(const float* __restrict query, const float* __restrict features, std::size_t dimension,
             std::size_t count, float* __restrict distances) noexcept {
  const std::size_t num_in_blocks = dimension / kLanes * kLanes;
  for (std::size_t f = 0; f < count; ++f) {
    const float* const feature = features + f * dimension;
    alignas(64) std::array<float, kLanes> sums{};
    for (std::size_t i = 0; i < num_in_blocks; i += kLanes) {
      for (std::size_t k = 0; k < kLanes; ++k) {
        const float d = query[i + k] - feature[i + k];
        sums[k] += d * d;
      }
    }
    for (std::size_t i = num_in_blocks; i < dimension; ++i) {
      const float d = query[i] - feature[i];
      sums[i - num_in_blocks] += d * d;
    }
    for (std::size_t half = kLanes / 2; half > 0; half /= 2) {
      for (std::size_t k = 0; k < half; ++k) sums[k] += sums[k + half];
    }
    distances[f] = sums[0];
  }
}

}  // namespace

void compare_all(std::span<const float> queries, const FeaturePool& pool,
                 std::span<float> squared_distances) {
  const std::size_t d = pool.dimension, n = pool.size(), m = queries.size() / d;
  for (std::size_t first = 0; first < n; first += kFeaturesAtOnce) {
    const std::size_t count = std::min(kFeaturesAtOnce, n - first);
    for (std::size_t q = 0; q < m; ++q)
      compare(queries.data() + q * d, pool.features.data() + first * d, d, count,
              squared_distances.data() + q * n + first);
  }
}

std::vector<ScoredOutcome> match_with(const FeaturePool& pool, std::span<const float> queries,
                                      std::uint32_t model, PointsView true_places) {
  const std::size_t d = pool.dimension, n = pool.size(), m = queries.size() / d;
  std::vector<ScoredOutcome> outcomes(m);
  if (n == 0) return outcomes;
  engine::PerThread<Column<float>> scratch;
  engine::for_chunks(m, kQueriesAtOnce, [&](std::size_t first, std::size_t count) {
    Column<float>& all = scratch.local();
    all.resize(count * n);
    compare_all(queries.subspan(first * d, count * d), pool, all);
    for (std::size_t q = 0; q < count; ++q) {
      const auto distances = std::span(all).subspan(q * n, n);
      const auto nearest =
          static_cast<std::size_t>(std::ranges::min_element(distances) - distances.begin());
      const std::uint32_t found = pool.models[nearest];
      const float reach = pool.reaches[found];
      const auto within_reach = [&](std::size_t i, const Eigen::Vector3f& place) {
        return (pool.keypoints[i] - place).norm() < reach;
      };
      const Eigen::Vector3f place = pool.keypoints[nearest];
      float second = std::numeric_limits<float>::infinity();
      for (std::size_t i = 0; i < n; ++i) {
        if (distances[i] >= second || (pool.models[i] == found && within_reach(i, place))) continue;
        second = distances[i];
      }
      const float ratio = second > 0 ? std::sqrt(distances[nearest] / second) : 1.0F;
      outcomes[first + q] = {
          .score = 1 - static_cast<double>(ratio),
          .right = found == model && within_reach(nearest, true_places[first + q])};
    }
  });
  return outcomes;
}

}  // namespace trivet::bench

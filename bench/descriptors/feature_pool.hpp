/// Features at known positions, and the quality of nearest-neighbor matches with them.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/evaluation/score_curves.hpp"
#include "storage/common/columns.hpp"
#include "storage/data/points.hpp"

namespace trivet::bench {

/// The features of all models and their positions.
struct FeaturePool {
  std::size_t dimension = 0;
  Column<float> features;  ///< `dimension` numbers each
  std::vector<std::uint32_t> models;
  Points keypoints;            // /< positions on the models
  std::vector<float> reaches;  // /< per model: nearer positions count as the same

  std::size_t size() const noexcept { return models.size(); }
};

/// Squared Euclidean distances of each of m queries to all n features: m rows of n. The search is
/// exhaustive, as no other finds the second neighbor at another position. Same bits on any
/// processor.
void compare_all(std::span<const float> queries, const FeaturePool& pool,
                 std::span<float> squared_distances);

/// Matches the features of one model's scan with their nearest neighbors in the pool.
///
/// queries      m features
/// true_places  m positions on the model
/// Returns for each query a score and whether the match is right. The score is 1 minus the ratio of
/// the distance to the nearest feature and the distance to the nearest feature of another model or
/// of a position out of reach. A match is right if the nearest feature belongs to this model and
/// lies within reach of the true position. Deterministic for any number of threads.
/// Sources: the ratio is that of Lowe, IJCV 2004; right matches as in Guo et al., IJCV 2013.
std::vector<ScoredOutcome> match_with(const FeaturePool& pool, std::span<const float> queries,
                                      std::uint32_t model, PointsView true_places);

}  // namespace trivet::bench

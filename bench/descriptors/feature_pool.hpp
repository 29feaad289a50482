/// Features of known places, and what matching with the nearest of them is worth.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/evaluation/score_curves.hpp"
#include "storage/common/columns.hpp"
#include "storage/data/points.hpp"

namespace trivet::bench {

/// The features of all models, and where each is.
struct FeaturePool {
  std::size_t dimension = 0;
  Column<float> features;  ///< `dimension` numbers each
  std::vector<std::uint32_t> models;
  Points keypoints;            ///< of the models
  std::vector<float> reaches;  ///< one a model: places nearer than that are the same

  std::size_t size() const noexcept { return models.size(); }
};

/// Squared Euclidean distances of each of m queries to all n features: m rows of n. Exact search,
/// as there is no other that finds the second neighbor of another place.
/// Same bits on any processor.
void compare_all(std::span<const float> queries, const FeaturePool& pool,
                 std::span<float> squared_distances);

/// Match the features of one model's scan with the nearest of the pool.
///
/// queries      m features
/// true_places  m positions on the model
/// Returns for each 1 less the ratio of its distance to that of the nearest feature of another
/// model or of a place out of reach, and whether the nearest is of this model and within reach of
/// the true place. Deterministic for any number of threads.
/// Source: the ratio of Lowe, IJCV 2004; right matches as in Guo et al., IJCV 2013.
std::vector<ScoredOutcome> match_with(const FeaturePool& pool, std::span<const float> queries,
                                      std::uint32_t model, PointsView true_places);

}  // namespace trivet::bench

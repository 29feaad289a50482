/// Comparison of models that claim the same place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <vector>

#include "engine/loaded_library/recognizer.hpp"
#include "engine/selection/select_poses.hpp"
#include "engine/verification/pose_tester.hpp"
#include "kernels/verification/compare_poses.hpp"
#include "storage/common/result.hpp"

namespace trivet::engine {

/// A posed model at a place that another one claims too.
struct Rival {
  std::uint32_t model = 0;  ///< index in the library
  Pose T_scene_model = Pose::Identity();
  float score = 0;
};

/// The rival of a row of the table.
inline Rival rival_of(const PoseTable& table, Row row) {
  return {table.model[row], table.T_scene_model[row], table.score[row]};
}

/// Smallest share of a pose's score that a rival must have.
inline constexpr float kRivalScore = 0.5F;

/// Add a row to the poses of its model at a place, unless it repeats a placement or there are four:
/// a near symmetry may put what differs on either side of each of two axes.
///
/// poses   of the scene
/// rivals  rows of one model, the best first
void add_rival(const TestedPoses& poses, Row row, std::vector<Row>& rivals);

struct RivalComparison {
  /// Log odds that the first rival is here rather than the second one.
  double log_odds = 0;
  bool coincide = false;                   ///< whether most of their surfaces coincide
  Pose T_second_first = Pose::Identity();  ///< the first model as it was compared with the second
  std::size_t num_measured = 0;            ///< rays that tell them apart, at the second one's pose
};

/// Compare two models by the pixels where they differ (kernels::compare_poses).
///
/// If most of their surfaces coincide, differences of their poses, which come from noise, would
/// hide those of their shapes. So both are compared in the same two places, the second one's and the
/// first one's: one is laid on the other by what they have in common. Each counts in the place where
/// it is likelier, as a model 2 mm longer is found 1 mm aside. What is not measured is no evidence:
/// surfaces that differ in a few pixels differ beside an edge, where there are shadows.
/// In 358 places of scans of eight variants of a block by three sensors, 173 of 176 models with an
/// identity above 0.9 were right, compared with 176 of 187 with missing measurements, and 166 of 183
/// by the mean of both places (docs/verification.md, "Other answers").
/// Other models are compared in their own poses (rival_log_odds).
///
/// Errors: internal (no memory for a model's ray-tracing tree), damaged.
Result<RivalComparison> compare_rivals(const Recognizer& recognizer, const PreparedScene& scene,
                                       const PoseTestOptions& test, const Rival& first,
                                       const Rival& second, kernels::CompareScratch& scratch);

/// The comparisons of a scene. Places are settled several times, by what is selected, and most of
/// their rivals are the same: each comparison is made once. Thread-safe.
class RivalComparisons {
 public:
  /// Keeps references to all arguments.
  RivalComparisons(const Recognizer& recognizer, const PreparedScene& scene,
                   const PoseTestOptions& test)
      : recognizer_(recognizer), scene_(scene), test_(test) {}

  /// compare_rivals of the scene. Errors: as for compare_rivals.
  Result<RivalComparison> of(const Rival& first, const Rival& second,
                             kernels::CompareScratch& scratch);

 private:
  struct Before {
    bool operator()(const Rival& a, const Rival& b) const noexcept;
  };
  using OfFirst = std::map<Rival, RivalComparison, Before>;

  const Recognizer& recognizer_;
  const PreparedScene& scene_;
  const PoseTestOptions& test_;
  std::mutex mutex_;
  std::map<Rival, OfFirst, Before> made_;
};

}  // namespace trivet::engine

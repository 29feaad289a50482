/// Comparison of an answer with the other answers in the scene.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "engine/selection/compare_rivals.hpp"
#include "engine/selection/select_poses.hpp"
#include "storage/common/result.hpp"

namespace trivet::engine {

/// Factor on a score's odds, where `others` are the scores of the other answers of its model in the
/// scene. A scan with many nearly as likely answers and few certain ones shows that other things
/// look like the model. With o the odds and p the probabilities,
///   1 / (1 + c / 0.05),  c = sum_j min(1, o_j / o) p_j (1 - p_j) / (1 + sum_j p_j^2).
/// The idea is that of the local false discovery rate: how credible a case is depends on what was
/// found beside it. Source: Efron, Large-Scale Inference, 2010, ch. 5.
float odds_in_crowd(float score, std::span<const float> others) noexcept;

/// Poses that were selected down to doubtful ones, and the poses that they hide.
class OtherAnswers {
 public:
  /// Keeps references to all arguments. Errors: internal (no memory for a model's ray-tracing
  /// tree).
  static Result<OtherAnswers> among(RivalComparisons& comparisons, const TestedPoses& poses,
                                    const SelectOptions& select);

  /// Lower the score of a settled pose by the crowd of other answers of its model, and note which
  /// models it may be.
  ///
  /// Candidates are the other models that claim the same pixels with at least half its score; they
  /// may be hidden by the pose or by the one chosen in its place. Their shares follow from how well
  /// each explains the pixels where it differs from the pose (compare_rivals). Those with less than
  /// a hundredth are told apart and left out. The score becomes the probability that any candidate
  /// is here, which is at least that of each. Candidates of another shape lower it by their share:
  /// where unlike shapes fit equally well, none may be there (score_beside_strange).
  ///
  /// row  row of the settled pose
  /// Errors: internal (no memory for a model's ray-tracing tree).
  /// Returns the best row of another model that explains those pixels better, if any does.
  Result<std::optional<Row>> weigh(Row row, SettledPose& settled) const;

 private:
  OtherAnswers(RivalComparisons& comparisons, const TestedPoses& poses, Selection selection);
  std::map<std::uint32_t, std::vector<Row>> rivals_at(Row row) const;
  Result<std::optional<Row>> note_candidates(Row row, SettledPose& settled) const;

  RivalComparisons& comparisons_;
  const TestedPoses& poses_;
  Selection selection_;
  std::vector<std::vector<Row>> answers_;  // chosen poses, by model
};

}  // namespace trivet::engine

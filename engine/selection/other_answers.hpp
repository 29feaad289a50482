/// Comparison of an answer with the other answers in the scene.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "engine/loaded_library/recognizer.hpp"
#include "engine/selection/select_poses.hpp"
#include "engine/verification/pose_tester.hpp"
#include "kernels/verification/compare_poses.hpp"
#include "storage/common/result.hpp"

namespace trivet::engine {

/// Factor on a score's odds, where `others` are the scores of the other answers of its model in the
/// scene. A scan with many nearly as likely answers and few certain ones shows that other things
/// look like the model. With o the odds and p the probabilities,
///   1 / (1 + c / 0.03),  c = sum_j min(1, o_j / o) p_j (1 - p_j) / (1 + sum_j p_j^2).
/// The idea is that of the local false discovery rate: how credible a case is depends on what was
/// found beside it. Source: Efron, Large-Scale Inference, 2010, ch. 5.
float odds_in_crowd(float score, std::span<const float> others) noexcept;

/// Number of models searched for. Among many models, those compared fit best by chance, so the same
/// pixels carry less evidence.
enum class Among : std::uint8_t { few_models, many_models };

/// Poses that were selected down to doubtful ones, and the poses that they hide.
class OtherAnswers {
 public:
  /// Keeps references to all arguments. Errors: internal (no memory for a model's ray-tracing
  /// tree).
  static Result<OtherAnswers> among(const Recognizer& recognizer, const TestedPoses& poses,
                                    const SelectOptions& select, const PoseTestOptions& test,
                                    Among among);

  /// Lower the score of a settled pose by the crowd of other answers of its model, and by its
  /// siblings. Siblings are other models that claim the same pixels with at least half its score;
  /// they may be hidden by the pose or by the one chosen in its place. The probability is divided
  /// according to how well each one explains the pixels where they differ (kernels::compare_poses;
  /// among many models also by the scores, rival_log_odds). Siblings with at least a tenth of the
  /// pose's share are included and noted.
  ///
  /// row  row of the settled pose
  /// Errors: internal (no memory for a model's ray-tracing tree).
  Result<void> weigh(Row row, SettledPose& settled) const;

 private:
  OtherAnswers(const Recognizer& recognizer, const TestedPoses& poses, const PoseTestOptions& test,
               Among among, Selection selection);
  double sibling_log_odds(Row sibling, Row row,
                          const kernels::PoseComparison& comparison) const noexcept;
  std::map<std::uint32_t, std::vector<Row>> siblings_of(Row row, Row holder) const;
  Result<void> share_with_siblings(Row row, SettledPose& settled) const;

  const Recognizer& recognizer_;
  const TestedPoses& poses_;
  const PoseTestOptions& test_;
  const Among among_;
  Selection selection_;
  std::vector<std::vector<Row>> answers_;  // chosen poses, by model
};

}  // namespace trivet::engine

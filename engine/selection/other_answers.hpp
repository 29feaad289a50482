/// Hold an answer against the others that the scene gave.
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

/// What a score's odds are multiplied by where `others` are the scores of the other answers of its
/// model in the scene: a scan in which many are nearly as likely, and few are sure, shows what
/// looks like the model without being it. With o the odds and p the probabilities,
///   1 / (1 + c / 0.03),  c = sum_j min(1, o_j / o) p_j (1 - p_j) / (1 + sum_j p_j^2).
/// Source of the idea: the local false discovery rate, Efron, Large-Scale Inference, 2010, ch. 5:
/// how far a case is to be believed depends on what was found beside it.
float odds_in_crowd(float score, std::span<const float> others) noexcept;

/// How many models the answers were sought of: of many, those that fit best by chance are compared,
/// and the same pixels tell less.
enum class Among : std::uint8_t { few_models, many_models };

/// Poses that were selected down to doubtful ones, and what they hide.
class OtherAnswers {
 public:
  /// All arguments are referred to. Errors: internal (no memory for a model's ray-tracing tree).
  static Result<OtherAnswers> among(const Recognizer& recognizer, const TestedPoses& poses,
                                    const SelectOptions& select, const PoseTestOptions& test,
                                    Among among);

  /// Lower the score of a settled pose by the crowd of other answers of its model, and by its
  /// siblings: other models that claim the same pixels with at least half its score, be they hidden
  /// by it or by what was chosen in its place. Of these the probability is shared by how well each
  /// explains the pixels where they differ (kernels::compare_poses; among many models also by the
  /// scores, rival_log_odds), with those that keep a tenth of its share; these are noted.
  ///
  /// row  that the settled pose is of
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
  std::vector<std::vector<Row>> answers_;  // chosen, by model
};

}  // namespace trivet::engine

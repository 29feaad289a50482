#include "engine/selection/other_answers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/selection/odds.hpp"
#include "engine/selection/settle_rivals.hpp"
#include "kernels/verification/compare_poses.hpp"
#include "storage/common/stop.hpp"

namespace trivet::engine {
namespace {

// Scores from which answers count toward a crowd. They are independent of min_score, since a score
// must not depend on it.
constexpr float kAnswer = 0.02F, kReportedUsually = 0.8F;
// Fitted to the scenes of scripts/calibrate with drawn sensors, with 748 correct and 103 wrong
// detections of scores from 0.8. The log loss of all answers from 0.02 falls from 0.278 to 0.197,
// and to 0.193 with siblings. The score has been fitted anew since, and knows more wrong answers
// itself: on the real sets the average precision is 0.939 by 0.03 and 0.944 by 0.05 and 0.08.
constexpr double kCrowd = 0.05;
constexpr float kSiblingScore = 0.5F;  // share of the pose's score
// The votes of compare_poses are for blocks whose errors are correlated in the worst case. By the
// same scenes, in which few models are searched for, they carry four times as much evidence.
constexpr double kVoteWeight = 4;
// Minimum share relative to the pose's; models with less are distinguishable.
constexpr double kNoted = 0.1;
constexpr std::size_t kPosesOfSibling = 2;  // number of best poses to compare

SelectOptions down_to_answers(SelectOptions options) {
  options.min_score = kReportedUsually;
  options.doubtful_score = kAnswer;
  options.max_instances = std::numeric_limits<std::uint32_t>::max();
  return options;
}

}  // namespace

float odds_in_crowd(float score, std::span<const float> others) noexcept {
  const auto odds = [](double p) { return p / std::max(1 - p, 1e-6); };
  double doubts = 0, sure = 0;
  for (const float other : others) {
    const auto p = static_cast<double>(other);
    const double as_likely =
        std::min(1.0, odds(p) / std::max(odds(static_cast<double>(score)), 1e-6));
    doubts += as_likely * p * (1 - p);
    sure += p * p;
  }
  return static_cast<float>(1 / (1 + doubts / (1 + sure) / kCrowd));
}

Result<OtherAnswers> OtherAnswers::among(const Recognizer& recognizer, const TestedPoses& poses,
                                         const SelectOptions& select, const PoseTestOptions& test,
                                         Among among) {
  Selection selection = select_poses(poses, down_to_answers(select));
  TRIVET_TRY(settle_rivals(recognizer, poses, test, selection));
  return OtherAnswers(recognizer, poses, test, among, std::move(selection));
}

OtherAnswers::OtherAnswers(const Recognizer& recognizer, const TestedPoses& poses,
                           const PoseTestOptions& test, Among among, Selection selection)
    : recognizer_(recognizer),
      poses_(poses),
      test_(test),
      among_(among),
      selection_(std::move(selection)),
      answers_(poses.library.models.size()) {
  for (const Row row : selection_.chosen) answers_[poses.table.model[row]].push_back(row);
}

Result<void> OtherAnswers::weigh(Row row, SettledPose& settled) const {
  const PoseTable& table = poses_.table;
  std::vector<float> others;
  for (const Row other : answers_[table.model[row]]) {
    if (other != row) others.push_back(table.score[other]);
  }
  float& score = settled.pose.score;
  score = scale_odds(score, odds_in_crowd(table.score[row], others));
  return share_with_siblings(row, settled);
}

double OtherAnswers::sibling_log_odds(Row sibling, Row row,
                                      const kernels::PoseComparison& comparison) const noexcept {
  return among_ == Among::few_models
             ? kVoteWeight * comparison.log_ratio
             : rival_log_odds(poses_.table.score[sibling], poses_.table.score[row], comparison);
}

/// The best poses of other models at this place, by model.
///
/// holder  chosen pose at the place: the pose itself, or the one chosen instead
std::map<std::uint32_t, std::vector<Row>> OtherAnswers::siblings_of(Row row, Row holder) const {
  const PoseTable& table = poses_.table;
  std::map<std::uint32_t, std::vector<Row>> siblings;
  const auto add = [&](Row other) {
    if (table.model[other] == table.model[row] ||
        table.score[other] < kSiblingScore * table.score[row])
      return;
    std::vector<Row>& of_model = siblings[table.model[other]];
    if (of_model.size() < kPosesOfSibling) of_model.push_back(other);
  };
  add(holder);
  for (const Refusal& refusal : selection_.refused) {
    if (refusal.explained_by == holder) add(refusal.row);
  }
  return siblings;
}

Result<void> OtherAnswers::share_with_siblings(Row row, SettledPose& settled) const {
  const PoseTable& table = poses_.table;
  Row holder = row;
  for (const Refusal& refusal : selection_.refused) {
    if (refusal.row == row && refusal.explained_by) holder = *refusal.explained_by;
  }
  const auto siblings = siblings_of(row, holder);
  if (siblings.empty()) return {};

  const Pose& pose = settled.pose.T_scene_model;
  TRIVET_TRY_ASSIGN(const TestedModel tested, tested_model(poses_.library, table.model[row]));
  const PoseTester tester(tested, poses_.scene, test_);
  const auto surface = recognizer_.surface(table.model[row]);
  if (!surface) return surface.error();
  kernels::CompareScratch scratch;
  double all = 1;  // sum of the shares of probability, relative to the pose's
  for (const auto& [sibling, rows] : siblings) {
    const auto other_surface = recognizer_.surface(sibling);
    if (!other_surface) return other_surface.error();
    TRIVET_TRY_ASSIGN(const TestedModel other_model, tested_model(poses_.library, sibling));
    // The pose chosen first at this place is at least as likely, by its score.
    const bool first =
        among_ == Among::few_models && holder != row && sibling == table.model[holder];
    double best = first ? 0 : std::numeric_limits<double>::lowest();
    for (const Row other : rows) {
      check_stop();
      const kernels::PoseComparison comparison = kernels::compare_poses(
          poses_.scene.images, {**other_surface, other_model.samples, table.T_scene_model[other]},
          {**surface, tester.samples(), pose}, tester.errors_of(pose), tester.strict(pose),
          scratch);
      best = std::max(best, sibling_log_odds(other, row, comparison));
    }
    // The choice was made by score, so a pose that is better in the differing pixels is at most as
    // likely.
    const double share = std::exp(std::min(0.0, best));
    if (share < kNoted) continue;
    all += share;
    settled.ambiguity.siblings.push_back(sibling);
  }
  settled.pose.score = static_cast<float>(static_cast<double>(settled.pose.score) / all);
  return {};
}

}  // namespace trivet::engine

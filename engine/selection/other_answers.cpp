#include "engine/selection/other_answers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "engine/selection/odds.hpp"
#include "engine/selection/settle_rivals.hpp"
#include "kernels/scoring/pose_score.hpp"
#include "storage/common/stop.hpp"

namespace trivet::engine {
namespace {

// Scores from which answers count toward a crowd. They are independent of min_score, since a score
// must not depend on it.
constexpr float kAnswer = 0.02F, kReportedUsually = 0.8F;
// Fitted to the scenes of scripts/calibrate with drawn sensors, with 748 correct and 103 wrong
// detections of scores from 0.8. The log loss of all answers from 0.02 falls from 0.278 to 0.197.
// The score has been fitted anew since, and knows more wrong answers itself: on the real sets the average precision is 0.939 by 0.03 and 0.944 by 0.05 and 0.08.
constexpr double kCrowd = 0.05;
// Smallest share of a candidate: one that is right in fewer than one of a hundred answers is told
// apart.
constexpr double kLeastShare = 0.01;
constexpr double kLeastOdds = 1e-6;

SelectOptions down_to_answers(SelectOptions options) {
  options.min_score = kReportedUsually;
  options.doubtful_score = kAnswer;
  options.max_instances = std::numeric_limits<std::uint32_t>::max();
  return options;
}

/// Share the probability by the odds, and leave out candidates that are told apart from the first.
void share_among(std::vector<PosedCandidate>& candidates) {
  const auto odds = [](const PosedCandidate& c) { return std::exp(c.log_odds); };
  const auto sum = [&] {
    double all = 0;
    for (const PosedCandidate& candidate : candidates) all += odds(candidate);
    return all;
  };
  const double all = sum();
  std::erase_if(candidates, [&](const PosedCandidate& c) { return odds(c) < kLeastShare * all; });
  const double kept = sum();
  for (PosedCandidate& candidate : candidates)
    candidate.share = static_cast<float>(odds(candidate) / kept);
  std::stable_sort(candidates.begin() + 1, candidates.end(),
                   [](const auto& a, const auto& b) { return a.share > b.share; });
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

Result<OtherAnswers> OtherAnswers::among(RivalComparisons& comparisons, const TestedPoses& poses,
                                         const SelectOptions& select) {
  Selection selection = select_poses(poses, down_to_answers(select));
  TRIVET_TRY(settle_rivals(comparisons, poses, selection));
  return OtherAnswers(comparisons, poses, std::move(selection));
}

OtherAnswers::OtherAnswers(RivalComparisons& comparisons, const TestedPoses& poses,
                           Selection selection)
    : comparisons_(comparisons),
      poses_(poses),
      selection_(std::move(selection)),
      answers_(poses.library.models.size()) {
  for (const Row row : selection_.chosen) answers_[poses.table.model[row]].push_back(row);
}

Result<std::optional<Row>> OtherAnswers::weigh(Row row, SettledPose& settled) const {
  const PoseTable& table = poses_.table;
  std::vector<float> others;
  for (const Row other : answers_[table.model[row]]) {
    if (other != row) others.push_back(table.score[other]);
  }
  float& score = settled.pose.score;
  score = scale_odds(score, odds_in_crowd(table.score[row], others));
  return note_candidates(row, settled);
}

/// The best poses of other models at the place of a pose, by model. The place is that of the pose
/// chosen there: the pose itself, or the one chosen instead.
std::map<std::uint32_t, std::vector<Row>> OtherAnswers::rivals_at(Row row) const {
  const PoseTable& table = poses_.table;
  Row holder = row;
  for (const Refusal& refusal : selection_.refused) {
    if (refusal.row == row && refusal.explained_by) holder = *refusal.explained_by;
  }
  std::map<std::uint32_t, std::vector<Row>> rivals;
  const auto add = [&](Row other) {
    if (table.model[other] != table.model[row] &&
        table.score[other] >= kRivalScore * table.score[row])
      add_rival(poses_, other, rivals[table.model[other]]);
  };
  add(holder);
  for (const Refusal& refusal : selection_.refused) {
    if (refusal.explained_by == holder) add(refusal.row);
  }
  return rivals;
}

Result<std::optional<Row>> OtherAnswers::note_candidates(Row row, SettledPose& settled) const {
  const PoseTable& table = poses_.table;
  const Rival own{table.model[row], settled.pose.T_scene_model, table.score[row]};
  std::vector<PosedCandidate>& candidates = settled.ambiguity.candidates;
  candidates = {{.model = own.model, .score = own.score, .T_scene_model = own.T_scene_model}};
  std::vector<std::uint32_t> strange;  // models of another shape
  std::optional<Row> better;
  double most = 0;
  kernels::CompareScratch scratch;
  for (const auto& [model, rows] : rivals_at(row)) {
    std::optional<PosedCandidate> best;
    bool coincides = false;
    for (const Row other : rows) {
      check_stop();
      TRIVET_TRY_ASSIGN(const RivalComparison comparison,
                        comparisons_.of(rival_of(table, other), own, scratch));
      if (comparison.log_odds > most) {
        most = comparison.log_odds;
        better = other;
      }
      // One that is better, but does not take the place, is as likely.
      const double log_odds = std::min(comparison.log_odds, 0.0);
      if (best && log_odds <= best->log_odds) continue;
      coincides = comparison.coincide;
      best = PosedCandidate{.model = model,
                            .score = table.score[other],
                            .T_scene_model = table.T_scene_model[other],
                            .T_first_model = comparison.T_second_first,
                            .log_odds = log_odds,
                            .num_measured = comparison.num_measured};
    }
    if (!coincides) strange.push_back(model);
    candidates.push_back(*best);
  }
  share_among(candidates);
  const float highest = std::ranges::max(candidates, {}, &PosedCandidate::score).score;
  const double more =
      kernels::log_odds(highest, kLeastOdds) - kernels::log_odds(own.score, kLeastOdds);
  float strange_share = 0;
  for (const PosedCandidate& candidate : candidates) {
    if (std::ranges::find(strange, candidate.model) != strange.end())
      strange_share += candidate.share;
  }
  settled.pose.score = score_beside_strange(
      scale_odds(settled.pose.score, static_cast<float>(std::exp(more))), strange_share);
  return better;
}

}  // namespace trivet::engine

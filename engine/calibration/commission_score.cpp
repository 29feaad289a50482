#include "engine/calibration/commission_score.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "kernels/scoring/fit_score.hpp"

namespace trivet {
namespace {

using kernels::ScoreAdaptation;
using kernels::ScoreModel;

constexpr std::size_t kMostFolds = 20;  // with more scans, several are left out together
constexpr std::array<float, 4> kSteps{1.0F, 0.75F, 0.5F, 0.25F};

std::size_t num_right(const Outcomes& outcomes) {
  return static_cast<std::size_t>(std::ranges::count(outcomes.right, 1));
}

void append(const Outcomes& from, std::size_t row, Outcomes& to) {
  to.parts.push_back(from.parts[row]);
  to.right.push_back(from.right[row]);
}

/// Scans that are left out together, and the fit to the others.
struct Fold {
  Outcomes left_out;
  ScoreAdaptation adaptation;
};

std::vector<Fold> fit_folds(const ScoreModel& model, const Outcomes& outcomes) {
  std::vector<Fold> folds(std::min(outcomes.scans.size(), kMostFolds));
  for (std::size_t f = 0; f < folds.size(); ++f) {
    Outcomes others;
    for (std::size_t row = 0; row < outcomes.right.size(); ++row)
      append(outcomes, row, outcomes.scan[row] % folds.size() == f ? folds[f].left_out : others);
    folds[f].adaptation = kernels::fit_adaptation(model, others.parts, others.right);
  }
  return folds;
}

ScoreTally tally(const ScoreModel& model, const Outcomes& outcomes, float least) {
  ScoreTally sums;
  if (outcomes.right.empty()) return sums;
  sums.log_loss = kernels::log_loss(model, outcomes.parts, outcomes.right);
  for (std::size_t i = 0; i < outcomes.right.size(); ++i) {
    if (kernels::pose_probability(model, outcomes.parts[i]) < least) continue;
    ++(outcomes.right[i] != 0 ? sums.right : sums.wrong);
  }
  return sums;
}

/// Effect of a step on the scans that are left out.
struct Trial {
  Commissioning found;
  std::size_t wrong_gained = 0;
};

void add_crossings(const ScoreModel& before, const ScoreModel& after, const Outcomes& outcomes,
                   float least, Trial& trial) {
  for (std::size_t i = 0; i < outcomes.right.size(); ++i) {
    const bool was = kernels::pose_probability(before, outcomes.parts[i]) >= least,
               is = kernels::pose_probability(after, outcomes.parts[i]) >= least;
    if (was == is) continue;
    const bool right = outcomes.right[i] != 0;
    ++(right ? (is ? trial.found.right_gained : trial.found.right_lost)
             : (is ? trial.wrong_gained : trial.found.wrong_lost));
  }
}

Trial try_step(const ScoreModel& model, const Outcomes& outcomes, std::span<const Fold> folds,
               const ScoreAdaptation& all, float share, float least) {
  Trial trial;
  Commissioning& found = trial.found;
  found.share = share;
  found.adaptation = kernels::part_of_the_way(all, share);
  for (const Fold& fold : folds) {
    const ScoreModel after =
        kernels::adapted_score(model, kernels::part_of_the_way(fold.adaptation, share));
    const ScoreTally sums = tally(after, fold.left_out, least);
    found.after.right += sums.right;
    found.after.wrong += sums.wrong;
    found.after.log_loss += sums.log_loss * static_cast<double>(fold.left_out.right.size()) /
                            static_cast<double>(outcomes.right.size());
    add_crossings(model, after, fold.left_out, least, trial);
  }
  // A wrong outcome must not rise by the fit to its own scan, either.
  Trial inside;
  add_crossings(model, kernels::adapted_score(model, found.adaptation), outcomes, least, inside);
  trial.wrong_gained += inside.wrong_gained;
  return trial;
}

bool is_worth_it(const Trial& trial, const ScoreTally& before, float least) {
  const double price = static_cast<double>(least) / (1 - static_cast<double>(least));
  const Commissioning& found = trial.found;
  const double gain = static_cast<double>(found.right_gained) -
                      static_cast<double>(found.right_lost) +
                      price * static_cast<double>(found.wrong_lost);
  return trial.wrong_gained == 0 && gain >= 0 && found.after.log_loss < before.log_loss;
}

double mean_score(const ScoreModel& model, const Outcomes& outcomes, std::uint8_t right) {
  double sum = 0;
  std::size_t n = 0;
  for (std::size_t i = 0; i < outcomes.right.size(); ++i) {
    if (outcomes.right[i] != right) continue;
    sum += static_cast<double>(kernels::pose_probability(model, outcomes.parts[i]));
    ++n;
  }
  return sum / static_cast<double>(n);
}

Result<void> check(const ScoreModel& model, const Outcomes& outcomes) {
  const std::size_t right = num_right(outcomes), wrong = outcomes.right.size() - right;
  if (outcomes.scans.size() < kLeastScans || right < kLeastMarks || wrong < kLeastMarks) {
    return Error{
        ErrorCode::bad_data,
        fmt::format("expected at least {} scans with {} right and {} wrong detections, "
                    "found {} with {} and {}; add scans, and detections of low scores, "
                    "which --min-score 0.02 lets a result contain",
                    kLeastScans, kLeastMarks, kLeastMarks, outcomes.scans.size(), right, wrong)};
  }
  const double of_right = mean_score(model, outcomes, 1), of_wrong = mean_score(model, outcomes, 0);
  if (of_right <= of_wrong) {
    return Error{ErrorCode::bad_data,
                 fmt::format("expected right detections of higher scores than wrong ones, found "
                             "means of {:.2f} and {:.2f}; check whether right and wrong are "
                             "swapped, or the truth is of other scans",
                             of_right, of_wrong)};
  }
  return {};
}

}  // namespace

Result<Commissioning> commission_score(const ScoreModel& model, const Outcomes& outcomes,
                                       float least) {
  TRIVET_TRY(check(model, outcomes));
  Commissioning best;
  best.before = best.after = tally(model, outcomes, least);
  best.num_right = num_right(outcomes);
  best.num_wrong = outcomes.right.size() - best.num_right;
  const std::vector<Fold> folds = fit_folds(model, outcomes);
  const ScoreAdaptation all = kernels::fit_adaptation(model, outcomes.parts, outcomes.right);
  for (const float share : kSteps) {
    Trial trial = try_step(model, outcomes, folds, all, share, least);
    if (trial.found.after.log_loss >= best.after.log_loss ||
        !is_worth_it(trial, best.before, least)) {
      continue;
    }
    trial.found.before = best.before;
    trial.found.num_right = best.num_right;
    trial.found.num_wrong = best.num_wrong;
    best = trial.found;
  }
  return best;
}

}  // namespace trivet

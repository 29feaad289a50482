#include "engine/selection/other_answers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "engine/selection/rival_odds.hpp"
#include "engine/selection/settle_rivals.hpp"
#include "kernels/verification/compare_poses.hpp"
#include "storage/common/stop.hpp"

namespace trivet::engine {
namespace {

// Answers from here on make a crowd, whatever is asked for: a score must not depend on that.
constexpr float kAnswer = 0.02F, kReportedUsually = 0.8F;
// By the scenes of scripts/calibrate with drawn sensors, 748 right and 103 wrong detections of 0.8
// and more; the log loss of all answers from 0.02 falls from 0.278 to 0.197, and to 0.193 with
// siblings.
constexpr double kCrowd = 0.03;
constexpr float kSiblingScore = 0.5F;  // of the candidate's
// Votes of compare_poses are of blocks that err alike at the most: by the same scenes, in which few
// models are searched for, they tell four times as much.
constexpr double kVotesTell = 4;
constexpr double kNoted = 0.1;              // of the candidate's share; with less, it is told apart
constexpr std::size_t kPosesOfSibling = 2;  // best ones, compared

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

Result<OtherAnswers> OtherAnswers::among(const Recognizer& recognizer, const PreparedScene& scene,
                                         std::span<const Candidate> candidates,
                                         const SelectOptions& select, const PoseTestOptions& test,
                                         Among among) {
  Selection selection =
      select_detections(recognizer.library(), scene, candidates, down_to_answers(select));
  TRIVET_TRY(settle_rivals(recognizer, scene, candidates, test, selection));
  return OtherAnswers(recognizer, scene, candidates, test, among, std::move(selection));
}

OtherAnswers::OtherAnswers(const Recognizer& recognizer, const PreparedScene& scene,
                           std::span<const Candidate> candidates, const PoseTestOptions& test,
                           Among among, Selection selection)
    : recognizer_(recognizer),
      scene_(scene),
      candidates_(candidates),
      test_(test),
      among_(among),
      selection_(std::move(selection)),
      answers_(recognizer.library().models.size()) {
  for (const std::uint32_t c : selection_.chosen) answers_[candidates[c].model].push_back(c);
}

Result<void> OtherAnswers::weigh(std::uint32_t index, Candidate& candidate) const {
  std::vector<float> others;
  for (const std::uint32_t c : answers_[candidate.model]) {
    if (c != index) others.push_back(candidates_[c].score);
  }
  candidate.score = scale_odds(candidate.score, odds_in_crowd(candidates_[index].score, others));
  return share_with_siblings(index, candidate);
}

double OtherAnswers::sibling_log_odds(const Candidate& sibling, const Candidate& candidate,
                                      const kernels::PoseComparison& comparison) const noexcept {
  return among_ == Among::few_models ? kVotesTell * comparison.log_ratio
                                     : rival_log_odds(sibling, candidate, comparison);
}

Result<void> OtherAnswers::share_with_siblings(std::uint32_t index, Candidate& candidate) const {
  const std::vector<Model>& models = recognizer_.library().models;
  // The one that was taken in its place, and those that this one hides.
  std::uint32_t holder = index;
  for (const RejectedCandidate& refusal : selection_.refused) {
    if (refusal.candidate == index && refusal.explained_by) holder = *refusal.explained_by;
  }
  std::map<std::uint32_t, std::vector<std::uint32_t>> siblings;  // candidates by model
  const auto add = [&](std::uint32_t c) {
    const Candidate& other = candidates_[c];
    if (other.model == candidate.model || other.score < kSiblingScore * candidates_[index].score)
      return;
    std::vector<std::uint32_t>& poses = siblings[other.model];
    if (poses.size() < kPosesOfSibling) poses.push_back(c);
  };
  add(holder);
  for (const RejectedCandidate& refusal : selection_.refused) {
    if (refusal.explained_by == holder) add(refusal.candidate);
  }
  if (siblings.empty()) return {};

  const Model& model = models[candidate.model];
  const PoseTester tester(model, scene_, model.ppf.quantization.distance_step, test_);
  const auto surface = recognizer_.surface(candidate.model);
  if (!surface) return surface.error();
  kernels::CompareScratch scratch;
  double all = 1;  // shares of the probability, that of the candidate being 1
  for (const auto& [sibling, poses] : siblings) {
    const auto other_surface = recognizer_.surface(sibling);
    if (!other_surface) return other_surface.error();
    const kernels::ModelSamples samples = samples_of(models[sibling]);
    // What was taken in this place first is as likely at least, by its score.
    const bool first =
        among_ == Among::few_models && holder != index && sibling == candidates_[holder].model;
    double best = first ? 0 : std::numeric_limits<double>::lowest();
    for (const std::uint32_t c : poses) {
      check_stop();
      const kernels::PoseComparison comparison = kernels::compare_poses(
          scene_.images, {**other_surface, samples, candidates_[c].T_scene_model},
          {**surface, tester.samples(), candidate.T_scene_model},
          tester.errors_of(candidate.T_scene_model), tester.strict(candidate.T_scene_model),
          scratch);
      best = std::max(best, sibling_log_odds(candidates_[c], candidates_[index], comparison));
    }
    // The score chose: what is better by the pixels that differ is no more than as likely.
    // What chose between both spoke for this one: the other is no more than as likely.
    const double share = std::exp(std::min(0.0, best));
    if (share < kNoted) continue;
    all += share;
    candidate.siblings.push_back(sibling);
  }
  candidate.score = static_cast<float>(static_cast<double>(candidate.score) / all);
  return {};
}

}  // namespace trivet::engine

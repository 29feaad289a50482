#include "engine/recognition/search_scene.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <iterator>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "engine/common/parallel.hpp"
#include "engine/hypotheses/cluster_proposals.hpp"
#include "engine/hypotheses/propose_by_matches.hpp"
#include "engine/hypotheses/propose_by_votes.hpp"
#include "engine/hypotheses/propose_expected.hpp"
#include "engine/loaded_library/find_look_alikes.hpp"
#include "engine/poses/placement.hpp"
#include "engine/results/stage_times.hpp"
#include "engine/selection/compare_rivals.hpp"
#include "engine/selection/decide_detections.hpp"
#include "engine/selection/select_poses.hpp"
#include "engine/selection/settle_alternatives.hpp"
#include "engine/verification/choose_rows.hpp"
#include "engine/verification/verify_poses.hpp"

namespace trivet::engine {
namespace {

constexpr std::size_t kSmoothingPoses = 24;  // that tell how the scan was smoothed
constexpr float kSamePlace = 0.5F;           // largest distance of their centers [mean diameter]
constexpr float kClimbsFrom = 0.5F;          // minimum score of poses whose look-alikes are tested
// Least agreement by samples of the poses in each portion that rays test. Of 14,685 refined poses in
// real scans 84 % agree by less than 0.4; without those on what better ones explain the same is found.
constexpr std::array<float, 3> kPortions{0.6F, 0.3F, 0};

/// Probabilities of a pose with each length of a filter.
using ByLength = std::array<float, kernels::kSmoothingLengths.size()>;

class SceneSearch {
 public:
  /// Keeps references to all arguments.
  SceneSearch(const Recognizer& recognizer, PreparedScene& scene, const SearchPlan& plan,
              SceneStats& stats)
      : recognizer_(recognizer),
        library_(recognizer.library()),
        scene_(scene),
        plan_(plan),
        stats_(stats),
        votes_(recognizer, scene, plan.groups, plan.large_planes, stats),
        matches_(recognizer, scene, plan.models, plan.large_planes, stats),
        verifier_(recognizer, scene, plan.verification, stats.times) {}

  Result<SearchResult> run() &&;

 private:
  Result<std::vector<Proposals>> propose(const RoundPlan& round);
  /// Models with the best screened poses, at most `limit`; a closer search may find them. Poses on
  /// explained pixels do not count.
  ModelGroups likely_models(std::size_t limit) const;

  /// Cluster and screen proposals, test the best of them, and repeat the selection among all poses.
  Result<void> verify(std::span<const Proposals> proposals);
  Result<void> screen(std::span<const Proposals> proposals);
  /// Refine the best of the waiting poses that nothing explains yet, and test them by rays. Poses
  /// beyond the limits continue to wait.
  Result<void> test_best();
  /// Test look-alikes of the chosen poses at their places.
  Result<void> test_look_alikes();
  Result<std::vector<std::vector<Row>>> suggest_look_alikes(std::span<const Row> rows);
  /// Move the chosen poses of models with near copies to their best alternatives, since a turned pose
  /// is no place to compare shapes, and test the near copies there, unless a pose of theirs that
  /// would be compared with the chosen one was tested.
  Result<void> test_near_copies();
  bool is_tested(std::uint32_t model, const Pose& pose, float least_score) const;
  Result<void> examine(std::span<const Row> rows);
  /// Test refined poses by rays in portions of falling agreement. Poses on what detections of
  /// earlier portions explain are left out.
  Result<void> examine_in_portions(std::vector<Row> rows);
  /// Remove the poses on explained pixels.
  void erase_explained(std::vector<Row>& rows) const;
  /// Find out by the best poses how a filter has smoothed the scan, and test all poses accordingly.
  Result<void> find_smoothing();
  /// The probabilities of the likeliest pose of each place, given those of all: a pose beside it fits
  /// better the more its model is smoothed.
  std::vector<ByLength> likeliest_of_places(std::span<const Row> rows,
                                            std::span<const ByLength> probabilities) const;
  void refine(std::span<const Row> rows);
  std::vector<Row> choose_to_examine(std::span<const Row> rows);

  Result<SearchResult> conclude() &&;

  const Recognizer& recognizer_;
  const Library& library_;
  PreparedScene& scene_;
  const SearchPlan& plan_;
  SceneStats& stats_;
  VoteSource votes_;
  MatchSource matches_;
  PoseVerifier verifier_;
  PoseTable table_;
  std::vector<Row> shortlist_;  // poses that were screened and are good enough for their model
  std::vector<Row> waiting_;    // waiting poses of the shortlist, in its order
  std::vector<Row> tested_;     // poses tested in full, in the order of their tests
  std::set<Row> climbed_;       // poses whose look-alikes were tested
  bool knows_smoothing_ = false;
  Selection selection_;  // selection among the tested poses
};

Result<SearchResult> SceneSearch::run() && {
  if (!plan_.expected.empty()) {
    TRIVET_TRY(verify(propose_expected(library_, plan_.groups, plan_.expected, scene_.scale)));
  }
  for (const RoundPlan& round : plan_.rounds) {
    const Result<std::vector<Proposals>> proposals = propose(round);
    if (!proposals) return proposals.error();
    TRIVET_TRY(verify(*proposals));
  }
  return std::move(*this).conclude();
}

Result<std::vector<Proposals>> SceneSearch::propose(const RoundPlan& round) {
  std::vector<Proposals> proposals;
  const auto add = [&](Result<std::vector<Proposals>> found) -> Result<void> {
    if (!found) return found.error();
    std::ranges::move(*found, std::back_inserter(proposals));
    return {};
  };
  if (const auto& votes = round.votes) {
    const ModelGroups models =
        votes->max_models >= plan_.models.size() ? plan_.groups : likely_models(votes->max_models);
    TRIVET_TRY(add(votes_.propose(models, votes->options, votes->max_pairs,
                                  plan_.verification.test.limits, selection_.explained)));
  }
  if (const auto& matches = round.matches) {
    MatchLevels levels = matches->levels;
    levels.finest = std::max(matches->finest_spacing * scene_.spacing,
                             matches->finest_noise * scene_.sensor.noise);
    TRIVET_TRY(add(matches_.propose(matches->options, levels, selection_.explained)));
  }
  return proposals;
}

ModelGroups SceneSearch::likely_models(std::size_t limit) const {
  const std::vector<std::uint8_t> is_explained =
      verifier_.lie_on(table_, shortlist_, selection_.explained);
  std::map<std::uint32_t, float> best;
  for (std::size_t k = 0; k < shortlist_.size(); ++k) {
    if (is_explained[k] != 0) continue;
    float& score = best[table_.model[shortlist_[k]]];
    score = std::max(score, table_.screen_score[shortlist_[k]]);
  }
  std::vector<std::pair<std::uint32_t, float>> order(best.begin(), best.end());
  std::ranges::stable_sort(order, std::ranges::greater(), &std::pair<std::uint32_t, float>::second);
  order.resize(std::min(order.size(), limit));
  std::ranges::sort(order);
  ModelGroups groups;
  for (const auto& [model, score] : order)
    groups[library_.shape(model).quantization.distance_step].push_back(model);
  return groups;
}

Result<void> SceneSearch::verify(std::span<const Proposals> proposals) {
  TRIVET_TRY(screen(proposals));
  for (std::uint32_t pass = 0; pass < plan_.limits.passes && !waiting_.empty(); ++pass) {
    TRIVET_TRY(test_best());
    for (std::uint32_t climb = 0; climb < plan_.limits.climbs; ++climb) {
      TRIVET_TRY(test_look_alikes());
    }
  }
  return {};
}

Result<void> SceneSearch::screen(std::span<const Proposals> proposals) {
  std::vector<Row> rows;
  {
    const StageTimer timer(stats_.times, "cluster");
    std::vector<std::uint32_t> models;
    for (const Proposals& of_model : proposals) models.push_back(of_model.model);
    TRIVET_TRY(verifier_.prepare(models));
    rows = cluster_proposals(library_, proposals,
                             {.pose = plan_.pose,
                              .limits = plan_.verification.test.limits,
                              .scale = scene_.scale,
                              .max_rows = plan_.limits.screened,
                              .keep_given_up = plan_.question.point.has_value()},
                             table_);
  }
  const StageTimer timer(stats_.times, "preselect");
  verifier_.screen(table_, rows);
  stats_.num_hypotheses += rows.size();
  const std::vector<Row> good = choose_of_each_model(
      table_, rows, library_, [&](const ModelInfo& model, std::span<const Row> of_model) {
        return choose_to_judge(table_, of_model, model, plan_.pose.max_refined);
      });
  shortlist_.insert(shortlist_.end(), good.begin(), good.end());
  waiting_.insert(waiting_.end(), good.begin(), good.end());
  return {};
}

Result<void> SceneSearch::test_best() {
  const VerificationLimits& limits = plan_.limits;
  std::vector<Row> rows;
  {
    const StageTimer timer(stats_.times, "preselect");
    erase_explained(waiting_);
    const std::size_t judged =
        limits.refined < kNoLimit / kContourShare ? kContourShare * limits.refined : kNoLimit;
    rows = extract_best(table_.score, judged, waiting_);
    verifier_.judge_contours(table_, rows);
    rows = choose_of_each_model(
        table_, rows, library_, [&](const ModelInfo& model, std::span<const Row> of_model) {
          return choose_to_refine(table_, of_model, model, plan_.pose.max_refined);
        });
    rows = extract_best(table_.score, limits.refined, rows);
  }
  refine(rows);
  rows = choose_to_examine(rows);
  return examine_in_portions(extract_best(table_.score, limits.examined, rows));
}

Result<void> SceneSearch::test_look_alikes() {
  std::vector<Row> from;
  for (const Row row : selection_.chosen) {
    if (table_.score[row] > kClimbsFrom && climbed_.insert(row).second) from.push_back(row);
  }
  if (from.empty()) return {};
  Result<std::vector<std::vector<Row>>> lists = suggest_look_alikes(from);
  if (!lists) return lists.error();
  std::vector<Row> all, chosen;
  for (const std::vector<Row>& list : *lists) all.insert(all.end(), list.begin(), list.end());
  refine(all);
  for (std::vector<Row>& list : *lists)
    std::ranges::copy(extract_best(table_.score, plan_.limits.look_alikes, list),
                      std::back_inserter(chosen));
  return examine(choose_to_examine(chosen));
}

/// Add rows for the models that look like each pose, at its place.
Result<std::vector<std::vector<Row>>> SceneSearch::suggest_look_alikes(std::span<const Row> rows) {
  const StageTimer timer(stats_.times, "match");
  const std::vector<LookAlike>* const none = nullptr;
  std::vector<Result<const std::vector<LookAlike>*>> found(rows.size(), none);
  for_each_index(rows.size(),
                 [&](std::size_t k) { found[k] = recognizer_.look_alikes(table_.model[rows[k]]); });
  std::vector<std::vector<Row>> lists(rows.size());
  std::vector<std::uint32_t> models;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (!found[k]) return found[k].error();
    for (const LookAlike& like : **found[k]) {
      if (!std::ranges::binary_search(plan_.models, like.model)) continue;
      models.push_back(like.model);
      const Pose pose = table_.T_scene_model[rows[k]] * like.T_model_other;
      lists[k].push_back(table_.add(like.model, Source::trisi, pose));
    }
  }
  TRIVET_TRY(verifier_.prepare(models));
  return lists;
}

Result<void> SceneSearch::test_near_copies() {
  if (plan_.limits.climbs == 0 || !plan_.decide.alternatives) return {};
  std::vector<Row> chosen;
  for (const Row row : selection_.chosen) {
    if (table_.score[row] > kClimbsFrom) chosen.push_back(row);
  }
  std::vector<std::vector<NearCopy>> copies(chosen.size());
  std::vector<Result<TestedPose>> best(chosen.size(), TestedPose{});
  const TestedPoses poses{library_, scene_, table_, tested_};
  for_each_index(chosen.size(), [&](std::size_t k) {
    const auto found = recognizer_.near_copies(table_.model[chosen[k]]);
    if (!found) {
      best[k] = found.error();
      return;
    }
    std::ranges::copy_if(**found, std::back_inserter(copies[k]), [&](const NearCopy& copy) {
      return std::ranges::binary_search(plan_.models, copy.model);
    });
    if (!copies[k].empty())
      best[k] = find_best_alternative(recognizer_, poses, plan_.decide.test, chosen[k]);
  });
  std::vector<std::uint32_t> models;
  std::vector<Row> added;
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    if (!best[k]) return best[k].error();
    if (copies[k].empty()) continue;
    const float least = kRivalScore * best[k]->score;
    table_.set_tested(chosen[k], *std::move(best[k]));
    std::size_t num_added = 0;
    for (const NearCopy& copy : copies[k]) {
      const Pose pose = table_.T_scene_model[chosen[k]] * copy.T_model_other;
      if (num_added == plan_.limits.near_copies) break;
      if (is_tested(copy.model, pose, least)) continue;
      models.push_back(copy.model);
      added.push_back(table_.add(copy.model, table_.source[chosen[k]], pose));
      ++num_added;
    }
  }
  if (added.empty()) return {};
  TRIVET_TRY(verifier_.prepare(models));
  return examine(added);
}

/// Whether a pose of a model at this placement was tested and has a score.
bool SceneSearch::is_tested(std::uint32_t model, const Pose& pose, float least_score) const {
  return std::ranges::any_of(tested_, [&](Row row) {
    return table_.model[row] == model && table_.score[row] >= least_score &&
           same_placement(library_.models[model], table_.T_scene_model[row], pose);
  });
}

void SceneSearch::refine(std::span<const Row> rows) {
  verifier_.refine(table_, rows);
  stats_.num_refined += rows.size();
}

std::vector<Row> SceneSearch::choose_to_examine(std::span<const Row> rows) {
  return choose_of_each_model(
      table_, rows, library_, [&](const ModelInfo& model, std::span<const Row> of_model) {
        return engine::choose_to_examine(table_, of_model, model, plan_.pose.max_examined,
                                         plan_.limits.least_score);
      });
}

Result<void> SceneSearch::examine(std::span<const Row> rows) {
  const Result<std::vector<Row>> within = verifier_.examine(table_, rows);
  recognizer_.release_memory();
  if (!within) return within.error();
  stats_.num_examined += rows.size();
  tested_.insert(tested_.end(), within->begin(), within->end());
  if (scene_.sensor.may_be_smoothed && !knows_smoothing_) TRIVET_TRY(find_smoothing());
  const StageTimer timer(stats_.times, "select");
  selection_ = select_poses({library_, scene_, table_, tested_}, plan_.decide.select);
  return {};
}

Result<void> SceneSearch::examine_in_portions(std::vector<Row> rows) {
  for (const float least : kPortions) {
    const auto later = std::stable_partition(rows.begin(), rows.end(),
                                             [&](Row row) { return table_.score[row] >= least; });
    std::vector<Row> portion(rows.begin(), later);
    rows.erase(rows.begin(), later);
    if (portion.empty()) continue;
    TRIVET_TRY(examine(portion));
    erase_explained(rows);
  }
  return {};
}

void SceneSearch::erase_explained(std::vector<Row>& rows) const {
  const std::vector<std::uint8_t> explained = verifier_.lie_on(table_, rows, selection_.explained);
  std::size_t k = 0;
  std::erase_if(rows, [&](Row) { return explained[k++] != 0; });
}

std::vector<ByLength> SceneSearch::likeliest_of_places(
    std::span<const Row> rows, std::span<const ByLength> probabilities) const {
  std::vector<std::size_t> order(rows.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, std::ranges::greater(),
                           [&](std::size_t k) { return std::ranges::max(probabilities[k]); });
  const auto overlap = [&](Row a, Row b) {
    const ModelInfo &first = library_.models[table_.model[a]],
                    &second = library_.models[table_.model[b]];
    const float apart =
        (table_.T_scene_model[a] * first.center - table_.T_scene_model[b] * second.center).norm();
    return apart < kSamePlace * 0.5F * (first.diameter + second.diameter);
  };
  std::vector<Row> places;
  std::vector<ByLength> out;
  for (const std::size_t k : order) {
    if (std::ranges::any_of(places, [&](Row place) { return overlap(place, rows[k]); })) continue;
    places.push_back(rows[k]);
    out.push_back(probabilities[k]);
  }
  return out;
}

Result<void> SceneSearch::find_smoothing() {
  const kernels::SensorModel unfiltered = scene_.sensor;
  std::vector<Row> all = tested_;
  const std::vector<Row> best = extract_best(table_.score, kSmoothingPoses, all);
  std::vector<ByLength> probabilities(best.size());
  for (std::size_t k = 0; k < kernels::kSmoothingLengths.size(); ++k) {
    scene_.sensor = unfiltered.smoothed_by(kernels::kSmoothingLengths[k]);
    scene_.sensor.correlation = 1;  // one kind of errors for all lengths: filters make such
    const Result<std::vector<float>> scores = verifier_.full_scores(table_, best);
    if (!scores) return scores.error();
    for (std::size_t row = 0; row < best.size(); ++row) probabilities[row][k] = (*scores)[row];
  }
  const std::optional<float> smoothing =
      kernels::choose_smoothing(likeliest_of_places(best, probabilities));
  knows_smoothing_ = smoothing.has_value();
  scene_.sensor = unfiltered.smoothed_by(smoothing.value_or(0));
  if (!(scene_.sensor.smoothing > 0)) return {};
  const Result<std::vector<Row>> within = verifier_.examine(table_, tested_);
  if (!within) return within.error();
  tested_ = *within;
  return {};
}

Result<SearchResult> SceneSearch::conclude() && {
  SearchResult result;
  TRIVET_TRY(test_near_copies());
  {
    const StageTimer timer(stats_.times, "alternatives");
    Result<std::vector<Row>> detections =
        decide_detections(recognizer_, scene_, tested_, plan_.decide, selection_, table_);
    if (!detections) return detections.error();
    result.detections = *std::move(detections);
  }
  if (plan_.max_rejected > 0)
    result.rejected =
        best_refused(library_, table_, selection_.refused, result.detections, plan_.max_rejected);
  if (plan_.question.point) {
    auto explained = explain_place(library_, scene_, plan_.question, plan_.limits.least_score,
                                   verifier_, table_);
    if (!explained) return explained.error();
    result.explained = *std::move(explained);
  }
  result.poses = std::move(table_);
  return result;
}

}  // namespace

Result<SearchResult> search_scene(const Recognizer& recognizer, PreparedScene& scene,
                                  const SearchPlan& plan, SceneStats& stats) {
  return SceneSearch(recognizer, scene, plan, stats).run();
}

}  // namespace trivet::engine

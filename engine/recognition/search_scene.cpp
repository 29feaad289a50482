#include "engine/recognition/search_scene.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <tuple>
#include <utility>

#include "engine/common/check_models.hpp"
#include "engine/common/parallel.hpp"
#include "engine/hypotheses/find_hypotheses.hpp"
#include "engine/hypotheses/match_features.hpp"
#include "engine/loaded_library/find_look_alikes.hpp"
#include "engine/recognition/search_budget.hpp"
#include "engine/recognition/stage_options.hpp"
#include "engine/results/stage_times.hpp"
#include "engine/selection/other_answers.hpp"
#include "engine/selection/select_detections.hpp"
#include "engine/selection/settle_alternatives.hpp"
#include "engine/selection/settle_rivals.hpp"
#include "engine/verification/pose_pool.hpp"

namespace trivet::engine {
namespace {

/// Of poses that matches propose and votes do not. The score is fitted to what votes propose, and
/// what they leave over holds fewer objects: from 0.8 to 0.9, 28 of 35 such detections on 400
/// rendered scenes were right, and 71 of 76 of the others.
constexpr float kOddsBesideVotes = 0.55F;
constexpr std::size_t kMostExplained = 20;  // models of a place
constexpr float kClimbsFrom = 0.5F;         // score of a candidate whose look-alikes are tested

std::unique_ptr<PlaceWatch> watch_of(const RecognizeOptions& options, const Library& library,
                                     const PreparedScene& scene) {
  if (!options.explain.point) return nullptr;
  const Eigen::Vector3d place = scene.scale * *options.explain.point;
  return std::make_unique<PlaceWatch>(library, place.cast<float>(), scene.sensor.noise);
}

/// Only references whose model could lie within the limits vote.
void drop_far_references(const PoseLimits& limits, const PreparedScene& scene, float reach,
                         SceneLevel& level) {
  if (!limits.region) return;
  const auto scale = static_cast<float>(scene.scale);
  const Eigen::Array3f low = limits.region->low.cast<float>().array() * scale - reach;
  const Eigen::Array3f high = limits.region->high.cast<float>().array() * scale + reach;
  std::erase_if(level.references, [&](std::uint32_t i) {
    const Eigen::Array3f p = level.points[i].array();
    return !((p >= low).all() && (p <= high).all());
  });
}

std::vector<bool> wanted_models(const Library& library, const ModelGroups& groups) {
  std::vector<bool> wanted(library.models.size(), false);
  for (const auto& [step, models] : groups) {
    for (const std::uint32_t m : models) wanted[m] = true;
  }
  return wanted;
}

class SceneSearch {
 public:
  /// All arguments are referred to.
  SceneSearch(const Recognizer& recognizer, const PreparedScene& scene, const ModelGroups& groups,
              const RecognizeOptions& options, SceneStats& stats)
      : recognizer_(recognizer),
        library_(recognizer.library()),
        scene_(scene),
        groups_(groups),
        options_(options),
        settle_options_(settle_options(options)),
        select_options_(select_options(options)),
        wanted_(wanted_models(library_, groups)),
        budget_(budget_of(options, library_,
                          static_cast<std::size_t>(std::ranges::count(wanted_, true)))),
        stats_(stats),
        watch_(watch_of(options, library_, scene)),
        pool_(recognizer, scene, settle_options_, stats.times, watch_.get()) {}

  Result<SearchResult> run() &&;

 private:
  /// By model of the library.
  using AllProposals = std::vector<std::vector<Proposals>>;

  AllProposals propose_expected() const;
  Result<AllProposals> propose(std::uint32_t round);
  Result<void> vote(std::uint32_t round, AllProposals& proposals);
  Result<void> match(AllProposals& proposals);
  SceneSample sample(float step, std::span<const std::uint32_t> models) const;

  /// Verify what is proposed, and select anew among all candidates.
  Result<void> settle(AllProposals proposals);
  Result<void> take_in(Result<std::vector<Candidate>> tested);
  /// Test what looks like the candidates that were taken in their place.
  Result<void> test_look_alikes();

  /// Candidates, moved to where the scan speaks for them and scored anew.
  /// others  none where poses are not compared
  Result<std::vector<Candidate>> hold_against_alternatives(
      std::span<const std::uint32_t> chosen, const std::optional<OtherAnswers>& others);
  Result<SearchResult> conclude();
  /// The score that min_score is asked of.
  float asked_score(const Candidate& candidate) const;
  std::optional<Rejection> refusal_of(const Candidate& candidate, float least,
                                      std::span<const Candidate> better) const;
  /// Whether matches propose a pose that votes had the chance to propose and did not.
  bool is_beside_votes(const Candidate& candidate) const;
  /// What a refusal says of a candidate, the one that it is about.
  static RefusedCandidate refused(const RejectedCandidate& refusal, Candidate candidate,
                                  std::span<const std::uint32_t> chosen);
  /// Of the place that was asked about; chosen and detections as below.
  Result<std::vector<ExplainedModel>> explain(std::span<const std::uint32_t> chosen,
                                              std::span<const Candidate> detections);
  /// chosen  by detection, the candidate that it was
  std::vector<RefusedCandidate> best_rejected(std::span<const std::uint32_t> chosen,
                                              std::span<const Candidate> detections);

  const Recognizer& recognizer_;
  const Library& library_;
  const PreparedScene& scene_;
  const ModelGroups& groups_;
  const RecognizeOptions& options_;
  const SettleOptions settle_options_;
  const SelectOptions select_options_;
  const std::vector<bool> wanted_;            // by model of the library
  const std::optional<SearchBudget> budget_;  // none: every model on its own
  SceneStats& stats_;
  const std::unique_ptr<PlaceWatch> watch_;  // of the place that was asked about
  PosePool pool_;
  std::map<float, SceneSample> samples_;  // by sampling step, once it is voted with
  std::vector<SceneMatches> matches_;     // one a level of features, once they are matched
  bool matched_ = false;
  std::set<std::uint32_t> climbed_;    // candidates whose look-alikes were tested
  std::vector<Candidate> candidates_;  // of all rounds
  Selection selection_;                // among them
};

Result<SearchResult> SceneSearch::run() && {
  if (!options_.expected.empty()) {
    TRIVET_TRY(settle(propose_expected()));
  }
  for (std::uint32_t round = 0; round < options_.pose.rounds; ++round) {
    Result<AllProposals> proposals = propose(round);
    if (!proposals) return proposals.error();
    TRIVET_TRY(settle(std::move(*proposals)));
  }
  return conclude();
}

SceneSearch::AllProposals SceneSearch::propose_expected() const {
  AllProposals proposals(library_.models.size());
  for (const auto& [step, models] : groups_) {
    for (const std::uint32_t m : models) {
      std::vector<kernels::Hypothesis> hypotheses;
      for (const ExpectedPose& expected : options_.expected) {
        if (expected.model != library_.models[m].name) continue;
        hypotheses.push_back({expected.T_scene_model.cast<float>(), 1});
        hypotheses.back().T_scene_model.translation() *= static_cast<float>(scene_.scale);
      }
      proposals[m].push_back({Source::expected, std::move(hypotheses)});
    }
  }
  return proposals;
}

Result<SceneSearch::AllProposals> SceneSearch::propose(std::uint32_t round) {
  AllProposals proposals(library_.models.size());
  const bool fused = options_.method == Method::fused;
  // What votes find in the first round need not be described; within a budget it is the other way.
  const bool votes = budget_ ? fused && round > 0 : options_.method != Method::trisi;
  const bool matches =
      budget_ ? round == 0 : options_.method == Method::trisi || (fused && round > 0);
  if (votes) {
    TRIVET_TRY(vote(round, proposals));
  }
  if (matches) {
    TRIVET_TRY(match(proposals));
  }
  return proposals;
}

Result<void> SceneSearch::vote(std::uint32_t round, AllProposals& proposals) {
  VoteOptions options = round == 0 || budget_ ? options_.vote : options_.later;
  if (budget_) {
    options.reference_share = budget_->reference_share;
    options.max_votes = std::min(options.max_votes, budget_->max_votes);
  }
  std::vector<std::pair<float, std::vector<std::uint32_t>>> sizes(groups_.begin(), groups_.end());
  if (budget_) {
    const std::vector<std::uint32_t> likely =
        pool_.likely_models(budget_->voted_models, selection_.explained);
    for (auto& [step, models] : sizes) {
      std::ranges::sort(models);
      std::vector<std::uint32_t> kept;
      std::ranges::set_intersection(models, likely, std::back_inserter(kept));
      models = std::move(kept);
    }
    std::erase_if(sizes, [](const auto& size) { return size.second.empty(); });
  }
  std::vector<SceneLevel> levels(sizes.size());
  {
    const StageTimer timer(stats_.times, "subsample");
    for (const auto& [step, models] : sizes) samples_.try_emplace(step);
    for_each_index(sizes.size(), [&](std::size_t k) {
      const float step = sizes[k].first;
      SceneSample& sampled = samples_.at(step);
      if (sampled.points.size() == 0) sampled = sample(step, groups_.at(step));
      levels[k] = choose_voters(scene_, sampled, options, selection_.explained);
      drop_far_references(options_.limits, scene_, sampled.largest_diameter, levels[k]);
    });
  }
  const StageTimer timer(stats_.times, "vote");
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    const std::vector<std::uint32_t>& models = sizes[k].second;
    TRIVET_TRY(check_models(library_, models, ModelPart::pairs));
    VotedHypotheses voted = find_hypotheses(library_, levels[k], models, options);
    stats_.num_references += voted.num_references;
    stats_.num_pairs += voted.num_pairs;
    stats_.num_votes += voted.num_votes;
    for (std::size_t m = 0; m < models.size(); ++m)
      proposals[models[m]].push_back({Source::ppf, std::move(voted.of_model[m])});
  }
  recognizer_.give_back();
  return {};
}

Result<void> SceneSearch::match(AllProposals& proposals) {
  std::vector<std::uint32_t> wanted;
  for (const auto& [step, models] : groups_)
    wanted.insert(wanted.end(), models.begin(), models.end());
  std::ranges::sort(wanted);
  const StageTimer timer(stats_.times, "match");
  MatchOptions options = options_.match;
  float finest = 0;
  if (budget_) {
    options.num_neighbors = std::max(options.num_neighbors, budget_->num_neighbors);
    options.num_lists = std::max(options.num_lists, budget_->num_lists);
    finest = std::max(budget_->finest_spacing * scene_.spacing,
                      budget_->finest_noise * scene_.sensor.noise);
  }
  if (!std::exchange(matched_, true)) {
    const Result<const FeatureIndex*> index = recognizer_.features();
    if (!index) return index.error();
    for (std::size_t k = 0; k < (*index)->size(); ++k) {
      const FeatureLevel& level = (**index)[k];
      if (level.resolution < finest) continue;
      std::vector<std::uint32_t> models;
      std::ranges::set_intersection(level.models, wanted, std::back_inserter(models));
      // Coarser features are for what large libraries cannot vote for.
      const bool is_own = std::ranges::any_of(models, [&](std::uint32_t m) {
        return library_.models[m].features[0].resolution == level.resolution;
      });
      if (models.empty() || (!budget_ && !is_own)) continue;
      TRIVET_TRY(library_.check_level(k));
      matches_.push_back(match_features(library_.basis, level, scene_,
                                        sample(level.resolution, models), selection_.explained,
                                        options, [&] { recognizer_.give_back(); }));
      recognizer_.give_back();
    }
  }
  for (const SceneMatches& matches : matches_) {
    std::vector<std::vector<kernels::Hypothesis>> hypotheses = hypotheses_of(
        matches, scene_, selection_.explained, library_.models.size(), options_.match.grouping);
    for (const std::uint32_t m : wanted) {
      if (!hypotheses[m].empty()) proposals[m].push_back({Source::trisi, std::move(hypotheses[m])});
    }
  }
  return {};
}

SceneSample SceneSearch::sample(float step, std::span<const std::uint32_t> models) const {
  float largest = 0;
  for (const std::uint32_t m : models) largest = std::max(largest, library_.models[m].diameter);
  return sample_scene(scene_, step, largest, large_planes(options_));
}

Result<void> SceneSearch::settle(AllProposals proposals) {
  std::vector<ModelProposals> proposed;
  for (std::uint32_t m = 0; m < proposals.size(); ++m) {
    if (!proposals[m].empty()) proposed.push_back({m, std::move(proposals[m])});
  }
  const PoseBudget poses = budget_ ? budget_->poses : PoseBudget{};
  TRIVET_TRY(pool_.add(proposed, poses));
  const std::uint32_t passes = budget_ ? budget_->passes : 1;
  for (std::uint32_t pass = 0; pass < passes; ++pass) {
    std::span<const std::uint8_t> explained;
    if (budget_) explained = selection_.explained;
    TRIVET_TRY(take_in(pool_.test_best(poses, explained)));
    for (std::uint32_t climb = 0; budget_ && climb < budget_->climbs; ++climb) {
      TRIVET_TRY(test_look_alikes());
    }
  }
  stats_.num_hypotheses = pool_.num_looked_at();
  stats_.num_refined = pool_.num_refined();
  stats_.num_examined = pool_.num_examined();
  return {};
}

Result<void> SceneSearch::take_in(Result<std::vector<Candidate>> tested) {
  recognizer_.give_back();
  if (!tested) return tested.error();
  std::ranges::move(*tested, std::back_inserter(candidates_));
  const StageTimer timer(stats_.times, "select");
  selection_ = select_detections(library_, scene_, candidates_, select_options_);
  return {};
}

Result<void> SceneSearch::test_look_alikes() {
  std::vector<std::uint32_t> from;
  for (const std::uint32_t c : selection_.chosen) {
    if (candidates_[c].score > kClimbsFrom && climbed_.insert(c).second) from.push_back(c);
  }
  if (from.empty()) return {};
  std::vector<std::vector<SuggestedPose>> suggested(from.size());
  {
    const StageTimer timer(stats_.times, "match");
    std::vector<Result<void>> results(from.size());
    for_each_index(from.size(), [&](std::size_t k) {
      const Candidate& candidate = candidates_[from[k]];
      const auto look_alikes = recognizer_.look_alikes(candidate.model);
      if (!look_alikes) {
        results[k] = look_alikes.error();
        return;
      }
      for (const LookAlike& like : **look_alikes) {
        if (!wanted_[like.model]) continue;
        suggested[k].push_back({like.model, candidate.T_scene_model * like.T_model_other});
      }
    });
    for (const Result<void>& result : results) {
      if (!result) return result;
    }
  }
  return take_in(pool_.test(suggested, budget_->look_alikes));
}

Result<SearchResult> SceneSearch::conclude() {
  SearchResult result;
  std::vector<std::uint32_t> chosen, standing;  // all detections; those that are reported
  std::vector<std::pair<std::uint32_t, Candidate>> refused;
  // Those that are kept beside what is reported come from the first choice alone.
  float least = options_.doubtful_score.value_or(options_.min_score);
  std::optional<OtherAnswers> others;
  if (compares_alternatives(options_)) {
    const StageTimer timer(stats_.times, "alternatives");
    const PoseTestOptions& test = settle_options_.test;
    TRIVET_TRY(settle_rivals(recognizer_, scene_, candidates_, test, selection_));
    Result<OtherAnswers> found =
        OtherAnswers::among(recognizer_, scene_, candidates_, select_options_, test,
                            budget_ ? Among::many_models : Among::few_models);
    if (!found) return found.error();
    others.emplace(*std::move(found));
  }
  std::vector<std::uint32_t> next = selection_.chosen;
  while (!next.empty()) {
    Result<std::vector<Candidate>> settled = hold_against_alternatives(next, others);
    if (!settled) return settled.error();
    for (std::size_t k = 0; k < next.size(); ++k) {
      const std::uint32_t c = next[k];
      Candidate& candidate = (*settled)[k];
      if (const std::optional<Rejection> refusal =
              refusal_of(candidate, least, result.detections)) {
        selection_.refused.push_back({c, *refusal});
        refused.emplace_back(c, std::move(candidate));
        continue;
      }
      if (asked_score(candidate) >= options_.min_score) standing.push_back(c);
      result.detections.push_back(std::move(candidate));
      chosen.push_back(c);
    }
    // What is refused explains nothing: what it hid is held against its alternatives, too.
    least = options_.min_score;
    next = take_unexplained(sizes_of(scene_), claims_of(library_, candidates_, select_options_),
                            standing, select_options_, selection_.refused);
  }
  for (auto& [c, candidate] : refused) candidates_[c] = std::move(candidate);
  if (watch_) {
    auto explained = explain(chosen, result.detections);
    if (!explained) return explained.error();
    result.explained = *std::move(explained);
  }
  if (options_.max_rejected > 0) result.rejected = best_rejected(chosen, result.detections);
  return result;
}

Result<std::vector<Candidate>> SceneSearch::hold_against_alternatives(
    std::span<const std::uint32_t> chosen, const std::optional<OtherAnswers>& others) {
  const StageTimer timer(stats_.times, "alternatives");
  std::vector<Candidate> settled(chosen.size());
  for (std::size_t k = 0; k < chosen.size(); ++k) settled[k] = candidates_[chosen[k]];
  if (others) {
    std::vector<Result<void>> results(chosen.size());
    for_each_index(chosen.size(), [&](std::size_t k) {
      const Model& model = library_.models[settled[k].model];
      results[k] = settle_alternatives(recognizer_, scene_, model.ppf.quantization.distance_step,
                                       candidates_, settle_options_.test, settled[k]);
      if (results[k]) results[k] = others->weigh(chosen[k], settled[k]);
    });
    for (const Result<void>& result : results) {
      if (!result) return result.error();
    }
  }
  for (Candidate& candidate : settled) {
    if (is_beside_votes(candidate)) candidate.score = scale_odds(candidate.score, kOddsBesideVotes);
  }
  return settled;
}

bool SceneSearch::is_beside_votes(const Candidate& candidate) const {
  return !budget_ && options_.method == Method::fused && candidate.source == Source::trisi &&
         library_.models[candidate.model].has_pairs();
}

float SceneSearch::asked_score(const Candidate& candidate) const {
  return options_.require_pose ? candidate.score * candidate.pose_share : candidate.score;
}

std::optional<Rejection> SceneSearch::refusal_of(const Candidate& candidate, float least,
                                                 std::span<const Candidate> better) const {
  const bool repeats = std::ranges::any_of(better, [&](const Candidate& other) {
    return other.model == candidate.model &&
           same_placement(library_.models[other.model], other.T_scene_model,
                          candidate.T_scene_model);
  });
  if (repeats) return Rejection::explained;
  if (asked_score(candidate) < least) return Rejection::too_low;
  return std::nullopt;
}

std::vector<RefusedCandidate> SceneSearch::best_rejected(std::span<const std::uint32_t> chosen,
                                                         std::span<const Candidate> detections) {
  std::vector<RefusedCandidate> rejected;
  for (const RejectedCandidate& refusal :
       best_refused(library_, candidates_, selection_.refused, detections, options_.max_rejected)) {
    rejected.push_back(refused(refusal, std::move(candidates_[refusal.candidate]), chosen));
  }
  return rejected;
}

RefusedCandidate SceneSearch::refused(const RejectedCandidate& refusal, Candidate candidate,
                                      std::span<const std::uint32_t> chosen) {
  RefusedCandidate out;
  out.candidate = std::move(candidate);
  out.reason = refusal.reason;
  if (!refusal.explained_by) return out;
  const auto by = std::ranges::find(chosen, *refusal.explained_by);
  if (by == chosen.end()) return out;
  out.explained_by = static_cast<std::size_t>(by - chosen.begin());
  out.explained_share = refusal.explained_share;
  return out;
}

Result<std::vector<ExplainedModel>> SceneSearch::explain(std::span<const std::uint32_t> chosen,
                                                         std::span<const Candidate> detections) {
  const std::map<std::uint32_t, PlaceWatch::OfModel> seen = watch_->models();
  const std::vector<std::string>& asked = options_.explain.models;
  std::vector<ExplainedModel> explained;
  for (std::uint32_t m = 0; m < library_.models.size(); ++m) {
    const auto at = seen.find(m);
    const bool is_asked = std::ranges::find(asked, library_.models[m].name) != asked.end();
    if (asked.empty() ? at == seen.end() : !is_asked) continue;
    explained.push_back({.model = m});
    if (at != seen.end()) explained.back().num_poses = at->second.num_poses;
  }
  for (ExplainedModel& of : explained) {
    for (std::size_t d = 0; d < detections.size(); ++d) {
      if (detections[d].model != of.model ||
          !watch_->reaches(of.model, detections[d].T_scene_model, kTouch))
        continue;
      if (!of.detection || detections[d].score > detections[*of.detection].score) of.detection = d;
    }
    const RejectedCandidate* best = nullptr;
    for (const RejectedCandidate& refusal : selection_.refused) {
      const Candidate& candidate = candidates_[refusal.candidate];
      if (candidate.model != of.model ||
          !watch_->reaches(of.model, candidate.T_scene_model, kTouch))
        continue;
      if (best == nullptr || candidate.score > candidates_[best->candidate].score) best = &refusal;
    }
    if (best != nullptr && !of.detection)
      of.pose = refused(*best, candidates_[best->candidate], chosen);
  }
  const auto order = [&](const ExplainedModel& of) {
    const auto at = seen.find(of.model);
    const auto furthest = at == seen.end() ? std::nullopt : at->second.furthest;
    return std::tuple(!of.detection, of.pose ? -of.pose->candidate.score : 1.0F,
                      furthest ? -static_cast<int>(furthest->stage) : 1,
                      furthest ? -furthest->merit : 0.0F);
  };
  std::ranges::stable_sort(explained, {}, order);
  if (asked.empty()) explained.resize(std::min(explained.size(), kMostExplained));

  for (ExplainedModel& of : explained) {
    const auto at = seen.find(of.model);
    if (of.detection || of.pose || at == seen.end() || !at->second.furthest) continue;
    if (at->second.furthest->stage == PoseStage::examined) continue;  // it moved elsewhere
    const std::vector<SuggestedPose> given_up{{of.model, at->second.furthest->T_scene_model}};
    Result<std::vector<Candidate>> tested = pool_.test({&given_up, 1}, 1);
    if (!tested) return tested.error();
    of.given_up = true;
    if (!tested->empty()) of.pose = RefusedCandidate{std::move(tested->front())};
  }

  for (ExplainedModel& of : explained) {
    if (!of.detection && !of.pose) continue;
    const Candidate& at = of.detection ? detections[*of.detection] : of.pose->candidate;
    auto rays = pool_.judged_rays({of.model, at.T_scene_model});
    if (!rays) return rays.error();
    of.rays = *std::move(rays);
  }
  return explained;
}

}  // namespace

Result<SearchResult> search_scene(const Recognizer& recognizer, const PreparedScene& scene,
                                  const ModelGroups& groups, const RecognizeOptions& options,
                                  SceneStats& stats) {
  return SceneSearch(recognizer, scene, groups, options, stats).run();
}

}  // namespace trivet::engine

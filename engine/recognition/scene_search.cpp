#include "engine/recognition/scene_search.hpp"

#include <algorithm>
#include <utility>

#include "engine/common/parallel.hpp"
#include "engine/hypotheses/feature_library.hpp"
#include "engine/hypotheses/find_hypotheses.hpp"
#include "engine/verification/other_answers.hpp"
#include "engine/verification/settle_alternatives.hpp"

namespace trivet::engine {
namespace {

/// Of poses that matches propose and votes do not. The score is fitted to what votes propose, and
/// what they leave over holds fewer objects: from 0.8 to 0.9, 28 of 35 such detections on 400
/// rendered scenes were right, and 71 of 76 of the others.
constexpr float kOddsBesideVotes = 0.55F;

/// Only references whose model could lie within the limits vote.
void drop_far_references(const PoseLimits& limits, const PreparedScene& scene, float reach,
                         SceneLevel& level) {
  if (!limits.region) return;
  const auto scale = static_cast<float>(scene.scale);
  const Eigen::Array3f low = limits.region->low.array() * scale - reach;
  const Eigen::Array3f high = limits.region->high.array() * scale + reach;
  std::erase_if(level.references, [&](std::uint32_t i) {
    const Eigen::Array3f p = level.points[i].array();
    return !((p >= low).all() && (p <= high).all());
  });
}

}  // namespace

SceneSearch::SceneSearch(const Recognizer& recognizer, const PreparedScene& scene,
                         const ModelGroups& groups, const RecognizeOptions& options,
                         std::stop_token stop, SceneStats& stats)
    : recognizer_(recognizer),
      library_(recognizer.library()),
      scene_(scene),
      groups_(groups),
      options_(options),
      stop_(std::move(stop)),
      stats_(stats) {}

Result<void> SceneSearch::test_expected() {
  AllProposals proposals(library_.models.size());
  for (const auto& [step, models] : groups_) {
    for (const std::uint32_t m : models) {
      std::vector<kernels::Hypothesis> hypotheses;
      for (const ExpectedPose& expected : options_.expected) {
        if (expected.model != library_.models[m].name) continue;
        hypotheses.push_back({expected.T_scene_model, 1});
        hypotheses.back().T_scene_model.translation() *= static_cast<float>(scene_.scale);
      }
      proposals[m].push_back({Source::expected, std::move(hypotheses)});
    }
  }
  return settle(proposals);
}

Result<void> SceneSearch::search(std::uint32_t round) {
  AllProposals proposals(library_.models.size());
  const bool fused = options_.method == Method::fused;
  if (fused || options_.method == Method::ppf) vote(round, proposals);
  // What votes find in the first round need not be described.
  if (options_.method == Method::trisi || (fused && round > 0)) match(proposals);
  return settle(proposals);
}

void SceneSearch::vote(std::uint32_t round, AllProposals& proposals) {
  const VoteOptions& options = round == 0 ? options_.vote : options_.later;
  const std::vector<std::pair<float, std::vector<std::uint32_t>>> sizes(groups_.begin(),
                                                                        groups_.end());
  std::vector<SceneLevel> levels(sizes.size());
  {
    const StageTimer timer(stats_.times, "subsample");
    samples_.resize(sizes.size());
    for_each_index(sizes.size(), [&](std::size_t k) {
      if (round == 0) samples_[k] = sample(sizes[k].first, sizes[k].second);
      levels[k] = choose_voters(scene_, samples_[k], options, selection_.explained);
      drop_far_references(options_.limits, scene_, samples_[k].largest_diameter, levels[k]);
    });
  }
  const StageTimer timer(stats_.times, "vote");
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    const std::vector<std::uint32_t>& models = sizes[k].second;
    std::vector<std::vector<kernels::Hypothesis>> hypotheses =
        find_hypotheses(library_, levels[k], models, options, stats_);
    for (std::size_t m = 0; m < models.size(); ++m)
      proposals[models[m]].push_back({Source::ppf, std::move(hypotheses[m])});
  }
}

void SceneSearch::match(AllProposals& proposals) {
  std::vector<std::uint32_t> wanted;
  for (const auto& [step, models] : groups_)
    wanted.insert(wanted.end(), models.begin(), models.end());
  std::ranges::sort(wanted);
  const StageTimer timer(stats_.times, "match");
  if (!std::exchange(matched_, true)) {
    for (const FeatureLevel& level : recognizer_.features()) {
      std::vector<std::uint32_t> models;
      std::ranges::set_intersection(level.models, wanted, std::back_inserter(models));
      if (models.empty()) continue;
      matches_.push_back(match_features(library_.basis, level, scene_,
                                        sample(level.resolution, models), selection_.explained,
                                        options_.match));
    }
  }
  for (const SceneMatches& matches : matches_) {
    std::vector<std::vector<kernels::Hypothesis>> hypotheses = hypotheses_of(
        matches, scene_, selection_.explained, library_.models.size(), options_.match.grouping);
    for (const std::uint32_t m : wanted) {
      if (!hypotheses[m].empty()) proposals[m].push_back({Source::trisi, std::move(hypotheses[m])});
    }
  }
}

Result<void> SceneSearch::settle(const AllProposals& proposals) {
  for (std::uint32_t m = 0; m < proposals.size(); ++m) {
    if (proposals[m].empty()) continue;
    if (stop_.stop_requested()) return Error{ErrorCode::resumable, "stopped on request"};
    const float step = library_.models[m].ppf.quantization.distance_step;
    Result<std::vector<Candidate>> settled =
        settle_model(recognizer_, m, scene_, step, proposals[m], options_, stats_);
    if (!settled) return settled.error();
    std::ranges::move(*settled, std::back_inserter(candidates_));
  }
  const StageTimer timer(stats_.times, "select");
  selection_ = select_detections(library_, scene_, candidates_, options_);
  return {};
}

Result<std::vector<Candidate>> SceneSearch::chosen() {
  const std::vector<std::uint32_t> before = std::exchange(selection_.chosen, {});
  Result<std::vector<Candidate>> settled = settle_alternatives(before);
  if (!settled) return settled.error();
  std::vector<Candidate> out;
  for (std::size_t k = 0; k < before.size(); ++k) {
    const std::uint32_t c = before[k];
    Candidate& candidate = (*settled)[k];
    if (is_beside_votes(candidate)) candidate.score = scale_odds(candidate.score, kOddsBesideVotes);
    if (lies_at_one_of(out, candidate)) {
      selection_.refused.push_back({c, Rejection::explained});
      candidates_[c] = std::move(candidate);
      continue;
    }
    const float asked =
        options_.require_pose ? candidate.score * candidate.pose_share : candidate.score;
    if (asked < options_.doubtful_score.value_or(options_.min_score)) {
      selection_.refused.push_back({c, Rejection::too_low});
      candidates_[c] = std::move(candidate);
      continue;
    }
    selection_.chosen.push_back(c);
    out.push_back(std::move(candidate));
  }
  return out;
}

SceneSample SceneSearch::sample(float step, std::span<const std::uint32_t> models) const {
  float largest = 0;
  for (const std::uint32_t m : models) largest = std::max(largest, library_.models[m].diameter);
  return sample_scene(scene_, step, largest, options_.ablated);
}

Result<std::vector<Candidate>> SceneSearch::settle_alternatives(
    std::span<const std::uint32_t> chosen) {
  const StageTimer timer(stats_.times, "alternatives");
  std::vector<Candidate> settled(chosen.size());
  for (std::size_t k = 0; k < chosen.size(); ++k) settled[k] = candidates_[chosen[k]];
  if (options_.ablated.contains(Improvement::alternatives)) return settled;
  const OtherAnswers others(recognizer_, scene_, candidates_, options_);
  std::vector<Result<void>> results(chosen.size());
  for_each_index(chosen.size(), [&](std::size_t k) {
    const Model& model = library_.models[settled[k].model];
    results[k] =
        engine::settle_alternatives(recognizer_, scene_, model.ppf.quantization.distance_step,
                                    candidates_, options_, settled[k]);
    if (results[k]) results[k] = others.weigh(chosen[k], settled[k]);
  });
  for (const Result<void>& result : results) {
    if (!result) return result.error();
  }
  return settled;
}

bool SceneSearch::is_beside_votes(const Candidate& candidate) const {
  return options_.method == Method::fused && candidate.source == Source::trisi &&
         !library_.models[candidate.model].ppf.entries.empty();
}

bool SceneSearch::lies_at_one_of(std::span<const Candidate> better,
                                 const Candidate& candidate) const {
  return std::any_of(better.begin(), better.end(), [&](const Candidate& other) {
    return other.model == candidate.model &&
           same_placement(library_.models[other.model], other.T_scene_model,
                          candidate.T_scene_model);
  });
}

}  // namespace trivet::engine

#include "engine/recognition/search_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace trivet::engine {
namespace {

// Of so many keypoints one is described after votes. Of four draws of the points that vote in 25 sets
// of real scans, the average precision is 0.961 with these as with three tenths.
constexpr std::uint32_t kPartAfterVotes = 5;

/// Reset the options whose values alone implement an improvement in `options.ablated` to their
/// values without it. The other improvements are switched off in the stages.
RecognizeOptions without_ablated(RecognizeOptions options) {
  constexpr std::uint32_t kAll = std::numeric_limits<std::uint32_t>::max();
  const auto is_ablated = [&](Improvement improvement) {
    return options.ablated.contains(improvement);
  };
  if (is_ablated(Improvement::clusters)) {
    options.max_instances = 1;
    options.pose.cluster_translation = 0.1F;
    options.pose.cluster_rotation_deg = 12;
  }
  for (VoteOptions* vote : {&options.vote, &options.later}) {
    if (is_ablated(Improvement::ball)) vote->radius = 1;
    if (is_ablated(Improvement::full_cells)) vote->max_votes = kAll;
    if (is_ablated(Improvement::references)) vote->reference_share = 0.2F;
  }
  if (is_ablated(Improvement::normals)) options.normal_window = 2;
  if (is_ablated(Improvement::second_round))
    options.pose.rounds = std::min(options.pose.rounds, 1U);
  // The contour lowers the score of the visible surface; without visibility there is no such score.
  if (is_ablated(Improvement::visibility)) options.ablated.insert(Improvement::contour);
  if (is_ablated(Improvement::rays))
    options.ablated.insert(Improvement::alternatives);  // they are compared by rays
  return options;
}

/// Convert the options' points from the scene file's frame to the cloud's.
RecognizeOptions in_cloud_frame(RecognizeOptions options, const Eigen::Vector3d& offset) {
  for (ExpectedPose& expected : options.expected) expected.T_scene_model.translation() -= offset;
  if (auto& region = options.limits.region) {
    region->low -= offset;
    region->high -= offset;
  }
  if (options.explain.point) *options.explain.point -= offset;
  return options;
}

/// A single method must have been trained; the fused method uses what is available.
Result<void> check_methods(const Library& library, Method method) {
  const auto refuse = [&](const char* what, const char* name) {
    return Error{ErrorCode::usage,
                 fmt::format("{}: expected a library with {}, found none; train it with --methods "
                             "{}, or recognize with --method fused",
                             library.file.string(), what, name)};
  };
  const bool pairs = library.has_pairs();
  if (library.models.empty()) return {};
  if (method == Method::ppf && !pairs) return refuse("point pairs", "ppf");
  if (method == Method::trisi && library.basis.components.size() == 0)
    return refuse("Tri-Spin-Images", "trisi");
  return {};
}

/// The models with these names, rising; all models if there are no names.
Result<std::vector<std::uint32_t>> find_models(const Library& library,
                                               const std::vector<std::string>& names) {
  std::vector<std::uint32_t> models;
  for (std::uint32_t m = 0; names.empty() && m < library.models.size(); ++m) models.push_back(m);
  for (const std::string& name : names) {
    const auto found = std::ranges::find(library.models, name, &Model::name);
    if (found == library.models.end()) {
      return Error{ErrorCode::usage,
                   fmt::format("{}: expected a model named '{}', found none; `trivet library list` "
                               "shows the names",
                               library.file.string(), name)};
    }
    models.push_back(static_cast<std::uint32_t>(found - library.models.begin()));
  }
  std::ranges::sort(models);
  return models;
}

ModelGroups group_by_step(const Library& library, std::span<const std::uint32_t> models) {
  ModelGroups groups;
  for (const std::uint32_t m : models)
    groups[library.shape(m).quantization.distance_step].push_back(m);
  return groups;
}

/// Maximum work per scene. Some thirty models in a scene as large as a table stay below it.
struct WorkLimits {
  std::size_t screened = kNoLimit, refined = kNoLimit, examined = kNoLimit;
  std::size_t voted_models = kNoLimit;
  std::size_t votes = kNoLimit;         // per reference point, over all models
  std::size_t voting_pairs = kNoLimit;  // of a reference point and a model, in a round
};

/// No limits if votes reach only some models, and nothing chooses these.
WorkLimits work_limits(const RecognizeOptions& options, const Library& library,
                       std::size_t num_models) {
  const auto scaled = [&](double count) {
    return std::max<std::size_t>(
        1, static_cast<std::size_t>(std::llround(count * static_cast<double>(options.budget))));
  };
  const WorkLimits limits{scaled(30000), scaled(1000),    scaled(200),
                          scaled(60),    scaled(1200000), scaled(6000)};
  const bool has_index = options.method != Method::ppf && library.basis.components.size() > 0;
  const bool is_chosen = has_index || num_models <= limits.voted_models;
  return options.search == Search::exhaustive || !is_chosen ? WorkLimits{} : limits;
}

VotePlan plan_votes(VoteOptions options, std::size_t num_models, const WorkLimits& work) {
  const std::size_t voted = std::clamp<std::size_t>(num_models, 1, work.voted_models);
  options.max_votes = static_cast<std::uint32_t>(
      std::min<std::size_t>(options.max_votes, std::max<std::size_t>(1, work.votes / voted)));
  return {options, work.voted_models, work.voting_pairs};
}

/// Votes that come before leave few objects to find. If they do not reach all models, the correct
/// feature has more competitors among its neighbors, and coarser features detect what is small
/// compared with the scan's point spacing.
MatchPlan plan_matches(const MatchOptions& options, bool votes_first, bool votes_reach_all) {
  MatchPlan plan{options};
  if (votes_first)
    plan.options.max_keypoints = std::max(1U, options.max_keypoints / kPartAfterVotes);
  if (votes_reach_all) return plan;
  plan.options.num_neighbors = std::max(options.num_neighbors, 10U);
  plan.options.num_lists = std::max(options.num_lists, 8U);
  plan.levels.only_own = false;
  plan.finest_spacing = 0.7F;
  plan.finest_noise = 0.5F;
  return plan;
}

/// Voting comes first if it reaches every model, so that what it finds need not be described.
/// Otherwise matching comes first and chooses the models to vote for, since an index searches any
/// number of features. Later rounds search what no confident detection explains.
void plan_rounds(const RecognizeOptions& options, const Library& library, SearchPlan& plan) {
  const std::size_t num_models = plan.models.size();
  const WorkLimits work = work_limits(options, library, num_models);
  const bool votes_reach_all = num_models <= work.voted_models;
  plan.limits.screened = work.screened;
  plan.limits.refined = work.refined;
  plan.limits.examined = work.examined;
  if (num_models < 2) plan.limits.climbs = 0;  // nothing to climb to
  plan.decide.votes_first = votes_reach_all && options.method == Method::fused;
  const bool by_votes = options.method != Method::trisi, by_matches = options.method != Method::ppf;
  for (std::uint32_t round = 0; round < options.pose.rounds; ++round) {
    const bool is_first = round == 0;
    RoundPlan& now = plan.rounds.emplace_back();
    if (by_votes && (votes_reach_all || !is_first)) {
      const bool is_later = votes_reach_all && !is_first;
      now.votes = plan_votes(is_later ? options.later : options.vote, num_models, work);
    }
    if (by_matches && (!by_votes || is_first != votes_reach_all))
      now.matches = plan_matches(options.match, plan.decide.votes_first, votes_reach_all);
  }
}

}  // namespace

Result<SearchPlan> plan_search(const RecognizeOptions& asked, const Library& library,
                               const Eigen::Vector3d& offset) {
  const RecognizeOptions options = in_cloud_frame(without_ablated(asked), offset);
  const auto has = [&](Improvement improvement) { return !options.ablated.contains(improvement); };
  TRIVET_TRY(check_methods(library, options.method));
  Result<std::vector<std::uint32_t>> models = find_models(library, options.models);
  if (!models) return models.error();
  TRIVET_TRY(find_models(library, options.explain.models));

  SearchPlan plan;
  plan.prepare = {.normal_window = options.normal_window,
                  .correlated_noise = has(Improvement::correlated_noise)};
  plan.large_planes = has(Improvement::planes) ? LargePlanes::left_out : LargePlanes::kept;
  plan.models = *std::move(models);
  plan.groups = group_by_step(library, plan.models);
  plan.expected = options.expected;
  plan.pose = options.pose;
  plan.verification = {.test = {.verify = options.verify,
                                .limits = options.limits,
                                .refinement = has(Improvement::refinement),
                                .background = has(Improvement::background)},
                       .visibility = has(Improvement::visibility),
                       .contour = has(Improvement::contour),
                       .rays = has(Improvement::rays)};
  plan.decide = {.select = {.min_score = options.min_score,
                            .doubtful_score = options.doubtful_score,
                            .max_instances = options.max_instances,
                            .max_overlap = options.verify.max_overlap,
                            .by_pixels = has(Improvement::explained)},
                 .test = plan.verification.test,
                 .alternatives = has(Improvement::alternatives),
                 .require_pose = options.require_pose,
                 .require_identity = options.require_identity};
  plan.max_rejected = options.max_rejected;
  plan.question = options.explain;
  plan_rounds(options, library, plan);
  if (!has(Improvement::visibility)) plan.limits.least_score = 0;
  return plan;
}

}  // namespace trivet::engine

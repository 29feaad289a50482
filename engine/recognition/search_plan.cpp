#include "engine/recognition/search_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace trivet::engine {
namespace {

// Searching for each of so many models on its own costs about what the budget allows.
constexpr std::size_t kSmallLibrary = 30;

/// Set each option whose value is all that an improvement in `options.ablated` does back to what it
/// was before it; the stages are told of the others.
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
  // The contour lowers the score of what is seen: where that is not asked for, there is none.
  if (is_ablated(Improvement::visibility)) options.ablated.insert(Improvement::contour);
  if (is_ablated(Improvement::rays))
    options.ablated.insert(Improvement::alternatives);  // compared by rays
  return options;
}

/// What the options say of places in the scene's file, said of the cloud.
RecognizeOptions in_cloud_frame(RecognizeOptions options, const Eigen::Vector3d& offset) {
  for (ExpectedPose& expected : options.expected) expected.T_scene_model.translation() -= offset;
  if (auto& region = options.limits.region) {
    region->low -= offset;
    region->high -= offset;
  }
  if (options.explain.point) *options.explain.point -= offset;
  return options;
}

/// A method alone must have been trained for; both together take what there is.
Result<void> check_methods(const Library& library, Method method) {
  const auto refuse = [&](const char* what, const char* name) {
    return Error{ErrorCode::usage,
                 fmt::format("{}: expected a library with {}, found none; train it with --methods "
                             "{}, or recognize with --method fused",
                             library.file.string(), what, name)};
  };
  const bool pairs =
      std::ranges::any_of(library.models, [](const Model& model) { return model.has_pairs(); });
  if (library.models.empty()) return {};
  if (method == Method::ppf && !pairs) return refuse("point pairs", "ppf");
  if (method == Method::trisi && library.basis.components.size() == 0)
    return refuse("Tri-Spin-Images", "trisi");
  return {};
}

/// The models of these names, rising; of no names all.
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
    groups[library.models[m].ppf.quantization.distance_step].push_back(m);
  return groups;
}

/// Every model is searched for on its own: votes first, and what they find need not be described.
void plan_each_model(const RecognizeOptions& options, SearchPlan& plan) {
  for (std::uint32_t round = 0; round < options.pose.rounds; ++round) {
    RoundPlan& now = plan.rounds.emplace_back();
    if (options.method != Method::trisi) now.votes = {round == 0 ? options.vote : options.later};
    if (options.method == Method::trisi || (options.method == Method::fused && round > 0))
      now.matches = {options.match};
  }
  plan.decide.votes_first = options.method == Method::fused;
}

/// Work that does not grow with the library: matches first, since an index finds them among any
/// number of features; votes after them, on what no sure detection explains.
void plan_large_library(const RecognizeOptions& options, SearchPlan& plan) {
  const auto scaled = [&](double count) {
    return std::max<std::size_t>(
        1, static_cast<std::size_t>(std::llround(count * static_cast<double>(options.budget))));
  };
  plan.limits = {.screened = scaled(30000),
                 .refined = scaled(1000),
                 .examined = scaled(200),
                 .passes = 3,
                 .only_unexplained = true,
                 .climbs = 2,
                 .look_alikes = 8};
  VotePlan votes{options.vote, scaled(60)};
  votes.options.reference_share = 0.1F;
  votes.options.max_votes = std::min(votes.options.max_votes, 8000U);
  MatchPlan matches{options.match, {.only_own = false}, 0.7F, 0.5F};
  matches.options.num_neighbors = std::max(matches.options.num_neighbors, 10U);
  matches.options.num_lists = std::max(matches.options.num_lists, 8U);
  for (std::uint32_t round = 0; round < options.pose.rounds; ++round) {
    RoundPlan& now = plan.rounds.emplace_back();
    if (round == 0) {
      now.matches = matches;
    } else if (options.method == Method::fused) {
      now.votes = votes;
    }
  }
  plan.decide.among = Among::many_models;
  plan.decide.votes_first = false;
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
                 .require_pose = options.require_pose};
  plan.max_rejected = options.max_rejected;
  plan.question = options.explain;
  const bool is_large = plan.models.size() > kSmallLibrary && options.method != Method::ppf &&
                        library.basis.components.size() > 0 && options.search != Search::exhaustive;
  is_large ? plan_large_library(options, plan) : plan_each_model(options, plan);
  if (!has(Improvement::visibility)) plan.limits.least_score = 0;
  return plan;
}

}  // namespace trivet::engine

#include "engine/recognition/search_plan.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace trivet::engine {
namespace {

/// A library of this many models with two sampling steps, with or without features and pairs.
Library library_of(std::size_t num_models, bool features = true, std::uint32_t num_bins = 0) {
  std::vector<Model> models(num_models);
  for (std::size_t m = 0; m < num_models; ++m) {
    models[m].name = "part_" + std::to_string(m);
    models[m].ppf.quantization.distance_step = m % 2 == 0 ? 0.01F : 0.02F;
    models[m].ppf.quantization.num_distance_bins = num_bins;
  }
  Library library(std::move(models));
  if (features) library.basis.components.energies = {1};
  return library;
}

SearchPlan planned(const RecognizeOptions& options, const Library& library = library_of(2),
                   const Eigen::Vector3d& offset = {0, 0, 0}) {
  auto plan = plan_search(options, library, offset);
  EXPECT_TRUE(plan) << plan.error().message;
  return *std::move(plan);
}

TEST(PlanSearch, HasTheDefaultsOfTheStages) {
  const SearchPlan plan = planned({});
  EXPECT_EQ(plan.prepare, PrepareOptions{});
  EXPECT_EQ(plan.verification, VerificationOptions{});
  EXPECT_EQ(plan.decide, DecideOptions{});
  EXPECT_EQ(plan.large_planes, LargePlanes::left_out);
}

TEST(PlanSearch, LeavesOutAblatedParts) {
  const auto without = [](Improvement improvement) { return planned({.ablated = {improvement}}); };
  EXPECT_FALSE(without(Improvement::correlated_noise).prepare.correlated_noise);
  EXPECT_EQ(without(Improvement::normals).prepare.normal_window, 2.0F);
  EXPECT_EQ(without(Improvement::planes).large_planes, LargePlanes::kept);
  EXPECT_FALSE(without(Improvement::refinement).verification.test.refinement);
  EXPECT_FALSE(without(Improvement::background).verification.test.background);
  EXPECT_FALSE(without(Improvement::visibility).verification.visibility);
  EXPECT_FALSE(without(Improvement::visibility).verification.contour) << "it lowers that score";
  EXPECT_EQ(without(Improvement::visibility).limits.least_score, 0);
  EXPECT_FALSE(without(Improvement::contour).verification.contour);
  EXPECT_FALSE(without(Improvement::rays).verification.rays);
  EXPECT_FALSE(without(Improvement::rays).decide.alternatives) << "they are compared by rays";
  EXPECT_FALSE(without(Improvement::explained).decide.select.by_pixels);
  EXPECT_FALSE(without(Improvement::alternatives).decide.alternatives);
  EXPECT_EQ(without(Improvement::clusters).decide.select.max_instances, 1U);
  EXPECT_EQ(without(Improvement::ball).rounds[0].votes->options.radius, 1);
  EXPECT_EQ(without(Improvement::second_round).rounds.size(), 1U);
}

TEST(PlanSearch, TestsNoLookAlikesOfASingleModel) {
  EXPECT_EQ(planned({}, library_of(1)).limits.climbs, 0U);
  EXPECT_EQ(planned({.models = {"part_1"}}, library_of(5)).limits.climbs, 0U);
  EXPECT_GT(planned({}, library_of(2)).limits.climbs, 0U);
}

TEST(PlanSearch, NeverAddsARound) {
  EXPECT_TRUE(
      planned({.pose = {.rounds = 0}, .ablated = {Improvement::second_round}}).rounds.empty());
}

TEST(PlanSearch, UsesTheValuesOfRecognition) {
  RecognizeOptions options{.normal_window = 5.0F, .min_score = 0.3F, .doubtful_score = 0.1F};
  options.max_instances = 3;
  options.pose.max_refined = 7;
  options.verify = {.tolerance_sigmas = 2, .tolerance_diameters = 0.02F, .max_overlap = 0.1F};
  options.limits.tilt = PoseLimits::Tilt{.max_angle_deg = 9};
  const SearchPlan plan = planned(options);
  EXPECT_EQ(plan.prepare.normal_window, 5.0F);
  EXPECT_EQ(plan.pose, options.pose);
  EXPECT_EQ(plan.verification.test.verify, options.verify);
  EXPECT_EQ(plan.verification.test.limits, options.limits);
  EXPECT_EQ(
      plan.decide.select,
      (SelectOptions{
          .min_score = 0.3F, .doubtful_score = 0.1F, .max_instances = 3, .max_overlap = 0.1F}));
}

TEST(PlanSearch, BringsPlacesIntoTheFrameOfTheCloud) {
  RecognizeOptions options;
  options.limits.region = PoseLimits::Region{{10, 20, 30}, {11, 21, 31}};
  options.explain.point = Eigen::Vector3d(10, 20, 31);
  options.expected = {{"part_0", FilePose(Eigen::Translation3d(10, 20, 32))}};
  const SearchPlan plan = planned(options, library_of(2), {10, 20, 30});
  EXPECT_EQ(plan.verification.test.limits.region->high, Eigen::Vector3d(1, 1, 1));
  EXPECT_EQ(*plan.question.point, Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(plan.expected[0].T_scene_model.translation(), Eigen::Vector3d(0, 0, 2));
}

TEST(PlanSearch, GroupsModelsByTheirSteps) {
  const SearchPlan plan = planned({.models = {"part_3", "part_0", "part_1"}}, library_of(4));
  EXPECT_EQ(plan.models, (std::vector<std::uint32_t>{0, 1, 3}));
  EXPECT_EQ(plan.groups, (ModelGroups{{0.01F, {0}}, {0.02F, {1, 3}}}));
}

TEST(PlanSearch, RefusesModelsAndMethodsThatTheLibraryLacks) {
  const auto refused = [](const RecognizeOptions& options) {
    const auto plan = plan_search(options, library_of(2, false), {0, 0, 0});
    EXPECT_FALSE(plan);
    return plan ? ErrorCode::internal : plan.error().code;
  };
  EXPECT_EQ(refused({.models = {"nut"}}), ErrorCode::usage);
  EXPECT_EQ(refused({.explain = {Eigen::Vector3d(0, 0, 1), {"nut"}}}), ErrorCode::usage);
  EXPECT_EQ(refused({.method = Method::trisi}), ErrorCode::usage);
  EXPECT_EQ(refused({.method = Method::ppf}), ErrorCode::usage);
}

TEST(PlanSearch, VotesFirstWhereVotesReachEveryModel) {
  const SearchPlan small = planned({}, library_of(60)), large = planned({}, library_of(61));
  ASSERT_EQ(small.rounds.size(), 2U);
  EXPECT_TRUE(small.rounds[0].votes && !small.rounds[0].matches);
  EXPECT_TRUE(small.rounds[1].votes && small.rounds[1].matches);
  EXPECT_EQ(small.rounds[1].votes->options.radius, RecognizeOptions{}.later.radius);
  ASSERT_EQ(large.rounds.size(), 2U);
  EXPECT_TRUE(!large.rounds[0].votes && large.rounds[0].matches);
  EXPECT_TRUE(large.rounds[1].votes && !large.rounds[1].matches);
  EXPECT_EQ(large.rounds[1].votes->max_models, 60U);
}

TEST(PlanSearch, SearchesByOneMethodInEachRound) {
  const SearchPlan votes = planned({.method = Method::ppf}, library_of(100, true, 1)),
                   matches = planned({.method = Method::trisi}, library_of(100));
  for (std::size_t round = 0; round < 2; ++round) {
    EXPECT_TRUE(votes.rounds[round].votes && !votes.rounds[round].matches);
    EXPECT_TRUE(!matches.rounds[round].votes && matches.rounds[round].matches);
  }
}

TEST(PlanSearch, BoundsTheWorkOfASceneNotThatOfAModel) {
  const SearchPlan few = planned({}, library_of(30)), sixty = planned({}, library_of(60)),
                   thousand = planned({}, library_of(1000));
  EXPECT_EQ(few.limits.refined, thousand.limits.refined);
  EXPECT_EQ(few.rounds[0].votes->options.max_votes, VoteOptions{}.max_votes) << "no limit reached";
  EXPECT_EQ(sixty.rounds[0].votes->options.max_votes, 20000U);
  EXPECT_EQ(thousand.rounds[1].votes->options.max_votes, 20000U);
  const SearchPlan twice = planned({.budget = 2}, library_of(1000));
  EXPECT_EQ(2 * thousand.limits.examined, twice.limits.examined);
  EXPECT_EQ(twice.rounds[1].votes->max_models, 120U);
  EXPECT_EQ(few.rounds[0].votes->max_pairs, 6000U);
  EXPECT_EQ(twice.rounds[1].votes->max_pairs, 12000U);
}

TEST(PlanSearch, BoundsTheWorkOfVotesAloneWhereTheyReachAllModels) {
  const auto planned_votes = [](std::uint32_t num_models) {
    return planned({.method = Method::ppf}, library_of(num_models, true, 1));
  };
  EXPECT_EQ(planned_votes(60).rounds[0].votes->max_pairs, 6000U);
  EXPECT_EQ(planned_votes(60).limits.screened, planned({}, library_of(60)).limits.screened);
  EXPECT_EQ(planned_votes(61).rounds[0].votes->max_pairs, kNoLimit) << "nothing chooses models";
}

TEST(PlanSearch, DescribesFewerKeypointsAfterVotes) {
  const auto keypoints = [](const SearchPlan& plan, std::size_t round) {
    return plan.rounds[round].matches->options.max_keypoints;
  };
  EXPECT_EQ(keypoints(planned({}, library_of(60)), 1), 2000U);
  EXPECT_EQ(keypoints(planned({.match = {.max_keypoints = 1}}, library_of(60)), 1), 1U);
  EXPECT_EQ(keypoints(planned({}, library_of(61)), 0), 10000U) << "matches come first";
  EXPECT_EQ(keypoints(planned({.method = Method::trisi}, library_of(2)), 0), 10000U);
}

TEST(PlanSearch, HasNoLimitsWhereNothingChoosesModelsOrNoneAreAskedFor) {
  const SearchPlan featureless = planned({}, library_of(100, false)),
                   exhaustive = planned({.search = Search::exhaustive}, library_of(100));
  for (const SearchPlan* const plan : {&featureless, &exhaustive}) {
    EXPECT_EQ(plan->limits.refined, kNoLimit);
    EXPECT_EQ(plan->rounds[0].votes->max_models, kNoLimit);
    EXPECT_EQ(plan->rounds[0].votes->max_pairs, kNoLimit);
    EXPECT_EQ(plan->rounds[0].votes->options.max_votes, VoteOptions{}.max_votes);
  }
}

}  // namespace
}  // namespace trivet::engine

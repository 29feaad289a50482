#include <gtest/gtest.h>

#include <cmath>
#include <span>
#include <vector>

#include "engine/loaded_library/recognizer.hpp"
#include "engine/recognition/recognize.hpp"
#include "engine/training/train.hpp"
#include "kernels/common/counter_random.hpp"
#include "kernels/common/pose_math.hpp"
#include "support/rendered_scene.hpp"

namespace trivet {
namespace {

std::vector<Improvement> all_improvements() {
  std::vector<Improvement> all;
  for (std::size_t k = 0; k < kImprovements.size(); ++k) all.push_back(static_cast<Improvement>(k));
  return all;
}

TEST(Improvements, AreListedInTheOrderOfTheLadderEachByANameOfItsOwn) {
  const auto name = [](Improvement improvement) {
    return kImprovements[static_cast<std::size_t>(improvement)].name;
  };
  EXPECT_EQ(name(Improvement::clusters), "clusters");
  EXPECT_EQ(name(Improvement::full_cells), "full-cells");
  EXPECT_EQ(name(Improvement::contour), "contour");
  EXPECT_EQ(name(Improvement::correlated_noise), "correlated-noise");
  EXPECT_EQ(name(Improvement::alternatives), "alternatives");
  for (std::size_t i = 0; i < kImprovements.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) EXPECT_NE(kImprovements[i].name, kImprovements[j].name);
  }
}

TEST(ImprovementSet, HoldsWhatWasPutIn) {
  const ImprovementSet set{Improvement::clusters, Improvement::alternatives};
  for (const Improvement improvement : all_improvements()) {
    const bool expected =
        improvement == Improvement::clusters || improvement == Improvement::alternatives;
    EXPECT_EQ(set.contains(improvement), expected) << static_cast<int>(improvement);
  }
}

/// Two brackets, two levers and an unknown block in front of a wall, the depth noisy and wavy, and the
/// poses found with all improvements.
class WithoutImprovement : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const test::Shape bracket = test::bracket(), lever = test::lever();
    const test::Shape wall = test::box({-1, -1, 1.1F}, {1, 1, 1.2F});
    const test::Shape block = test::box({-0.06F, -0.05F, -0.03F}, {0.06F, 0.05F, 0.03F});
    std::vector<Model> models;
    for (const auto& [name, shape] : {std::pair{"bracket", &bracket}, std::pair{"lever", &lever}}) {
      auto trained =
          train_model(test::cloud_of(*shape), {name, std::string(name) + ".ply", 1, {}}, {});
      ASSERT_TRUE(trained) << trained.error().message;
      models.push_back(std::move(trained->model));
    }
    recognizer_ = Recognizer(Library(std::move(models)));
    scene_ =
        test::render_scan({{&wall, Pose::Identity()},
                           {&bracket, test::pose_of({2.1F, 0.7F, -0.4F}, {-0.15F, 0.03F, 0.85F})},
                           {&bracket, test::pose_of({-1.0F, 0.2F, 1.2F}, {0.05F, -0.1F, 0.95F})},
                           {&lever, test::pose_of({-0.6F, 0.5F, 1.9F}, {0.14F, 0.02F, 0.95F})},
                           {&lever, test::pose_of({0.3F, -0.4F, 0.9F}, {-0.06F, 0.1F, 0.92F})},
                           {&block, test::pose_of({0.4F, 0.9F, 0.2F}, {-0.12F, -0.12F, 0.9F})}});
    kernels::CounterRandom random(7, 0, 0);
    const std::span<float> z = scene_.points.span().z;
    for (std::size_t i = 0; i < z.size(); ++i) {
      const auto u = static_cast<double>(i % scene_.grid->width);
      const auto v = static_cast<double>(i / scene_.grid->width);
      const double wave = 0.0008 * std::sin(0.3 * u) * std::sin(0.3 * v);
      z[i] += static_cast<float>(wave + 0.0007 * random.normal());
    }
    complete_ = recognized({});
  }
  static SceneResult recognized(ImprovementSet ablated) {
    auto result = recognize(recognizer_, scene_, {}, {.min_score = 0.02F, .ablated = ablated});
    EXPECT_TRUE(result) << result.error().message;
    return std::move(*result);
  }
  /// The values of a result that are equal in every run.
  static std::vector<double> fingerprint(const SceneResult& result) {
    const SceneStats& s = result.stats;
    std::vector<double> out;
    for (const std::uint64_t count : {s.num_references, s.num_pairs, s.num_votes, s.num_hypotheses,
                                      s.num_refined, s.num_examined})
      out.push_back(static_cast<double>(count));
    out.push_back(static_cast<double>(s.times.seconds.size()));
    for (const Detection& detection : result.detections) {
      out.push_back(static_cast<double>(detection.score));
      for (const float value : detection.T_scene_model.matrix().reshaped())
        out.push_back(static_cast<double>(value));
    }
    return out;
  }
  static inline Recognizer recognizer_{Library{}};
  static inline Cloud scene_;
  static inline SceneResult complete_;
};

// Without votes from the wall, no pose depends on it, these parts have no alternatives, and wrong
// poses of scores that count do not overlap with right ones: `background`, `alternatives` and
// `explained` have separate tests.
TEST_F(WithoutImprovement, FindsSomethingElseForEach) {
  for (const Improvement improvement : all_improvements()) {
    if (improvement == Improvement::background || improvement == Improvement::alternatives ||
        improvement == Improvement::explained)
      continue;
    EXPECT_NE(fingerprint(recognized({improvement})), fingerprint(complete_))
        << kImprovements[static_cast<std::size_t>(improvement)].name;
  }
  EXPECT_EQ(fingerprint(recognized({})), fingerprint(complete_));
}

TEST_F(WithoutImprovement, MistakesTheWallForTheFlatSideOfAPart) {
  RecognizeOptions options;
  options.pose.rounds = 0;
  options.expected = {{"bracket", test::pose_of({0, 0, 0}, {0.25F, 0.2F, 1.1F}).cast<double>()}};
  options.ablated = {Improvement::contour};  // the wall continues beyond it
  const auto known = recognize(recognizer_, scene_, {}, options);
  options.ablated.insert(Improvement::background);
  const auto unknown = recognize(recognizer_, scene_, {}, options);
  ASSERT_TRUE(known && unknown);
  EXPECT_EQ(known->stats.num_examined, 0U) << "a wall supports no pose";
  EXPECT_EQ(unknown->stats.num_examined, 1U);
}

TEST_F(WithoutImprovement, NeedsMoreWork) {
  const SceneStats& s = complete_.stats;
  EXPECT_GT(recognized({Improvement::ball}).stats.num_pairs, s.num_pairs);
  EXPECT_GT(recognized({Improvement::full_cells}).stats.num_votes, s.num_votes);
  EXPECT_GT(recognized({Improvement::references}).stats.num_references, s.num_references);
  EXPECT_GT(recognized({Improvement::planes}).stats.num_references, s.num_references);
  EXPECT_LT(recognized({Improvement::second_round}).stats.num_references, s.num_references);
}

TEST_F(WithoutImprovement, KeepsOneInstanceOfEachModel) {
  const SceneResult result = recognized({Improvement::clusters});
  EXPECT_LE(result.detections.size(), 2U);
  EXPECT_GT(complete_.detections.size(), 2U);
}

TEST_F(WithoutImprovement, LeavesPosesAsTheyWereVotedWhereNoneIsRefined) {
  const SceneResult result = recognized({Improvement::refinement});
  ASSERT_FALSE(result.detections.empty());
  float best = 1;
  for (const Detection& detection : result.detections) {
    for (const Detection& known : complete_.detections) {
      const float apart =
          kernels::pose_distance(known.T_scene_model, detection.T_scene_model, {}, {0, 0, 0})
              .rotation_rad;
      EXPECT_GT(apart, 1e-4F);
      best = std::min(best, apart);
    }
  }
  EXPECT_LT(best, 0.2F);
}

// The method of the thesis: the strongest poses by votes alone, with shares that sum to at most 1.
TEST_F(WithoutImprovement, ScoresByVotesWhereAllIsLeftOut) {
  ImprovementSet all;
  for (const Improvement improvement : all_improvements()) all.insert(improvement);
  const auto result = recognize(recognizer_, scene_, {}, {.min_score = 0, .ablated = all});
  ASSERT_TRUE(result) << result.error().message;
  ASSERT_EQ(result->detections.size(), 2U) << "one a model";
  for (const Detection& detection : result->detections) {
    EXPECT_GT(detection.score, 0);
    EXPECT_LT(detection.score, 1);
  }
}

// Samples replace rays and fill the same counts.
TEST_F(WithoutImprovement, FindsTheSamePartsBySamplesWhereNoRaysAreShot) {
  const auto result = recognize(recognizer_, scene_, {}, {.ablated = {Improvement::rays}});
  ASSERT_TRUE(result) << result.error().message;
  ASSERT_EQ(result->detections.size(), 4U);
  for (const Detection& detection : result->detections) {
    EXPECT_GT(detection.visible_fraction, 0.5F);
    EXPECT_LT(detection.violation, 0.1F);
    EXPECT_GT(detection.rmse, 0);
    EXPECT_TRUE(std::isfinite(detection.rmse));
  }
}

}  // namespace
}  // namespace trivet

#include "apps/words/rejection_words.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "apps/words/score_words.hpp"
#include "engine/recognition/recognize.hpp"

namespace trivet::apps {
namespace {

double log_odds(double p) { return std::log(p) - std::log1p(-p); }

RejectedPose rejected_for(Rejection reason, float score = 0.4F) {
  RejectedPose rejected;
  rejected.model = "nut";
  rejected.score = score;
  rejected.reason = reason;
  return rejected;
}

SceneResult found_gear() {
  SceneResult result;
  result.detections.emplace_back().model = "gear";
  return result;
}

TEST(ScoreText, HasThreeDigitsOfWhichNoneIsMadeUp) {
  EXPECT_EQ(score_text(0.98449F), "0.984");
  EXPECT_EQ(score_text(0.5F), "0.500");
  EXPECT_EQ(score_text(0.99996F), "> 0.999");
  EXPECT_EQ(score_text(0), "< 0.001");
}

TEST(Deduction, MakesThePartsAddUpToTheScore) {
  kernels::ScoreModel model;
  model.bias = {-2, 1};
  for (auto& knots : model.knots) knots = {0, 1, 2, 3, 4};
  for (auto& weights : model.weights) weights.fill({0.1F, 0.2F, 0.1F, 0.3F});
  kernels::ScoreParts parts{};
  parts.fill(1.5F);
  parts[kernels::kCorrelationPart] = 0.25F;
  double sum = 0.75 * -2 + 0.25 * 1;
  for (std::size_t k = 0; k < parts.size(); ++k)
    sum += static_cast<double>(kernels::part_evidence(model, parts, k));
  for (const float score : {0.9F, 0.6F, 0.01F}) {
    EXPECT_NEAR(sum + static_cast<double>(deduction(model, parts, score)),
                log_odds(static_cast<double>(score)), 1e-3);
  }
  EXPECT_NEAR(deduction(model, parts, kernels::pose_probability(model, parts)), 0, 1e-5);
  EXPECT_TRUE(std::isfinite(deduction(model, parts, 0)));
}

TEST(RejectionWords, NameTheLimitInTheNotationOfScores) {
  RecognizeOptions options;
  options.min_score = 0.85F;
  const RejectionWords words =
      rejection_words(found_gear(), rejected_for(Rejection::too_low), default_score(), options);
  EXPECT_EQ(words.what, "below 0.85");
  EXPECT_EQ(words.text().find("below 0.85: "), 0U) << words.text();
}

TEST(RejectionWords, EndWithTheModelThatExplainsThePose) {
  RejectedPose explained = rejected_for(Rejection::explained, 0.95F);
  explained.explained_by = 0;
  explained.explained_share = 0.834F;
  EXPECT_EQ(rejection_words(found_gear(), explained, default_score(), {}).text(),
            "place taken: 83 % of its pixels are explained by gear");
  explained.reason = Rejection::too_low;
  RecognizeOptions very_pose;
  very_pose.require_pose = true;
  for (const RecognizeOptions& options : {RecognizeOptions{}, very_pose}) {
    EXPECT_TRUE(rejection_words(found_gear(), explained, default_score(), options)
                    .text()
                    .ends_with("; 83 % of its pixels are explained by gear"));
  }
}

TEST(RejectionWords, TellTheGroundAloneOfWhatIsInIt) {
  RejectedPose sunk = rejected_for(Rejection::too_low, 0);
  sunk.depth_in_ground = 0.134F;
  EXPECT_EQ(rejection_words(found_gear(), sunk, default_score(), {}).why,
            "it would be 13 % of its diameter deep in a table, a floor or a wall");
}

TEST(RejectionWords, StateTheRequestedNumber) {
  RecognizeOptions options;
  options.max_instances = 2;
  EXPECT_EQ(
      rejection_words(found_gear(), rejected_for(Rejection::too_many), default_score(), options)
          .text(),
      "one too many: 2 of this model were asked for, and better ones found");
}

}  // namespace
}  // namespace trivet::apps

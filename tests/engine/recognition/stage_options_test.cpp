#include "engine/recognition/stage_options.hpp"

#include <gtest/gtest.h>

namespace trivet::engine {
namespace {

TEST(StageOptions, HaveTheDefaultsOfRecognition) {
  EXPECT_EQ(prepare_options({}), PrepareOptions{});
  EXPECT_EQ(settle_options({}), SettleOptions{});
  EXPECT_EQ(select_options({}), SelectOptions{});
  EXPECT_EQ(large_planes({}), LargePlanes::left_out);
  EXPECT_TRUE(compares_alternatives({}));
}

TEST(StageOptions, TellEachStageWhatItLeavesOut) {
  const auto without = [](Improvement improvement) {
    return RecognizeOptions{.ablated = {improvement}};
  };
  EXPECT_FALSE(prepare_options(without(Improvement::correlated_noise)).correlated_noise);
  EXPECT_EQ(large_planes(without(Improvement::planes)), LargePlanes::kept);
  EXPECT_FALSE(settle_options(without(Improvement::refinement)).test.refinement);
  EXPECT_FALSE(settle_options(without(Improvement::background)).test.background);
  EXPECT_FALSE(settle_options(without(Improvement::visibility)).visibility);
  EXPECT_FALSE(settle_options(without(Improvement::contour)).contour);
  EXPECT_FALSE(settle_options(without(Improvement::rays)).rays);
  EXPECT_FALSE(select_options(without(Improvement::explained)).by_pixels);
  EXPECT_FALSE(compares_alternatives(without(Improvement::alternatives)));
}

TEST(StageOptions, TakeTheValuesOfRecognition) {
  RecognizeOptions options{.normal_window = 5.0F, .min_score = 0.3F, .doubtful_score = 0.1F};
  options.max_instances = 3;
  options.pose.max_refined = 7;
  options.verify = {.tolerance_sigmas = 2, .tolerance_diameters = 0.02F, .max_overlap = 0.1F};
  options.limits.tilt = PoseLimits::Tilt{.max_angle_deg = 9};
  EXPECT_EQ(prepare_options(options).normal_window, 5.0F);
  const SettleOptions settle = settle_options(options);
  EXPECT_EQ(settle.pose, options.pose);
  EXPECT_EQ(settle.test.verify, options.verify);
  EXPECT_EQ(settle.test.limits, options.limits);
  EXPECT_EQ(
      select_options(options),
      (SelectOptions{
          .min_score = 0.3F, .doubtful_score = 0.1F, .max_instances = 3, .max_overlap = 0.1F}));
}

}  // namespace
}  // namespace trivet::engine

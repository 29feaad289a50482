#include "engine/verification/verify_poses.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "engine/common/thread_limit.hpp"
#include "engine/selection/pixel_marks.hpp"
#include "kernels/common/pose_math.hpp"
#include "support/rendered_scene.hpp"
#include "support/trained_library.hpp"

namespace trivet::engine {
namespace {

using Rows = std::vector<Row>;

/// A bracket in front of a wall.
class VerifyPoses : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    static const test::Shape bracket = test::bracket();
    static const test::Shape wall = test::box({-1, -1, 1.4F}, {1, 1, 1.5F});
    recognizer_ =
        Recognizer(test::trained_library({{"bracket", &bracket}}, {.tri_spin_images = false}));
    StageTimes times;
    auto scene = prepare_scene(test::render_scan({{&wall, Pose::Identity()}, {&bracket, truth()}}),
                               {}, times);
    ASSERT_TRUE(scene) << scene.error().message;
    scene_ = std::move(*scene);
  }
  static Pose truth() { return test::pose_of({2.1F, 0.7F, -0.4F}, {-0.02F, 0.03F, 0.85F}); }
  /// Ten poses at increasing distance from the truth.
  static PoseTable ten_poses() {
    PoseTable table;
    for (int k = 0; k < 10; ++k) {
      Pose pose = truth();
      pose.translation().x() += 0.003F + 0.03F * static_cast<float>(k);
      table.add(0, Source::ppf, pose, 1, 0.1F);
    }
    return table;
  }
  PoseVerifier verifier() {
    PoseVerifier verifier(recognizer_, scene_, options_, times_);
    const std::uint32_t model = 0;
    EXPECT_TRUE(verifier.prepare({&model, 1}));
    return verifier;
  }
  static float error(const PoseTable& table, Row row) {
    return kernels::pose_distance(table.T_scene_model[row], truth(), {}, {0, 0, 0}).translation;
  }
  static inline Recognizer recognizer_{Library{}};
  static inline PreparedScene scene_;
  VerificationOptions options_;
  StageTimes times_;
};

TEST_F(VerifyPoses, ScreensTheRowsThatItIsGivenAndNoOthers) {
  PoseTable table = ten_poses();
  verifier().screen(table, Rows{0, 9});
  EXPECT_EQ(table.stage[0], PoseStage::screened);
  EXPECT_EQ(table.stage[1], PoseStage::proposed);
  EXPECT_EQ(table.score[1], 0);
  EXPECT_GT(table.score[0], 0.5F);
  EXPECT_LT(table.score[9], 0.5F * table.score[0]);
  EXPECT_EQ(table.screen_score[0], table.score[0]);
}

TEST_F(VerifyPoses, ContoursOnlyLowerScores) {
  PoseTable table = ten_poses();
  const PoseVerifier verifier = this->verifier();
  const Rows rows{0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
  verifier.screen(table, rows);
  verifier.judge_contours(table, rows);
  for (const Row row : rows) EXPECT_LE(table.score[row], table.screen_score[row]) << row;
}

TEST_F(VerifyPoses, RefinesToTheTruthAndDistinguishesItByRays) {
  PoseTable table = ten_poses();
  const PoseVerifier verifier = this->verifier();
  verifier.refine(table, Rows{0});
  EXPECT_LT(error(table, 0), 0.001F);
  EXPECT_EQ(table.stage[0], PoseStage::refined);
  EXPECT_NEAR(table.T_proposed[0].translation().x() - truth().translation().x(), 0.003F, 1e-6F);
  const auto within = verifier.examine(table, Rows{0});
  ASSERT_TRUE(within) << within.error().message;
  EXPECT_EQ(*within, Rows{0});
  EXPECT_GT(table.score[0], 0.9F);
  EXPECT_FALSE(table.test(0).explained.pixels.empty());
  EXPECT_EQ(table.stage[0], PoseStage::examined);
}

// Refined from afar, a sheet of 2 mm that another one covers in part ends 4 mm and 1.8 degrees away.
TEST_F(VerifyPoses, StaysOnTheSheetThatAPoseLiesOn) {
  test::Shape sheet = test::box({-0.08F, -0.05F, 0}, {0.08F, 0.02F, 0.002F});
  sheet.join(test::box({-0.08F, 0.02F, 0}, {0.01F, 0.05F, 0.002F}));
  const test::Shape table = test::box({-1, -1, -0.1F}, {1, 1, 0}),
                    cover = test::box({-0.03F, -0.15F, 0.002F}, {0.3F, 0.15F, 0.006F});
  const Pose T_camera_table = test::pose_of({2.4F, 0, 0}, {0, 0, 0.6F});
  StageTimes times;
  const auto scene = prepare_scene(
      test::render_scan(
          {{&table, T_camera_table}, {&sheet, T_camera_table}, {&cover, T_camera_table}}),
      {}, times);
  ASSERT_TRUE(scene) << scene.error().message;
  const Recognizer recognizer(
      test::trained_library({{"sheet", &sheet}}, {.tri_spin_images = false}));
  PoseVerifier verifier(recognizer, *scene, options_, times_);
  const std::uint32_t model = 0;
  ASSERT_TRUE(verifier.prepare({&model, 1}));
  PoseTable poses;
  poses.add(0, Source::ppf, T_camera_table, 1, 0.1F);
  verifier.refine(poses, Rows{0});
  const auto error = kernels::pose_distance(poses.T_scene_model[0], T_camera_table, {}, {0, 0, 0});
  EXPECT_LT(error.translation, 0.001F);
  EXPECT_LT(error.rotation_rad, 0.003F);
}

TEST_F(VerifyPoses, GivesUpWhatMovesBeyondTheLimits) {
  options_.test.limits.region = PoseLimits::Region{{-0.019, -1, 0}, {1, 1, 2}};
  PoseTable table = ten_poses();
  const PoseVerifier verifier = this->verifier();
  ASSERT_TRUE(verifier.tester(0).allowed(table.T_scene_model[1]));
  verifier.refine(table, Rows{0});
  options_.test.limits.region->low.x() = truth().translation().x() + 1;
  const auto within = verifier.examine(table, Rows{0});
  ASSERT_TRUE(within) << within.error().message;
  EXPECT_TRUE(within->empty());
  EXPECT_EQ(table.fate[0], PoseFate::given_up);
}

TEST_F(VerifyPoses, KnowsWhatLiesOnMarkedPixels) {
  PoseTable table = ten_poses();
  const PoseVerifier verifier = this->verifier();
  ASSERT_TRUE(verifier.examine(table, Rows{0}));
  PixelMarks marks(scene_.images, 1);
  marks.mark(0, table.test(0).explained);
  const std::vector<std::uint8_t> marked = marks.marked([](std::uint32_t) { return true; });
  const std::vector<std::uint8_t> on = verifier.lie_on(table, Rows{0, 9}, marked);
  EXPECT_EQ(on, (std::vector<std::uint8_t>{1, 0}));
  EXPECT_EQ(verifier.lie_on(table, Rows{0, 9}, {}), (std::vector<std::uint8_t>{0, 0}));
}

TEST_F(VerifyPoses, ScoresByVotesWithoutVisibilityAndContour) {
  options_.visibility = options_.contour = false;
  PoseTable table = ten_poses();
  verifier().screen(table, Rows{3});
  EXPECT_EQ(table.score[3], table.share[3]);
}

TEST_F(VerifyPoses, GivesTheSameBytesForAnyNumberOfThreads) {
  const Rows rows{0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
  const auto scores = [&](unsigned threads) {
    const ThreadLimit limit(threads);
    PoseTable table = ten_poses();
    const PoseVerifier verifier = this->verifier();
    verifier.screen(table, rows);
    verifier.refine(table, rows);
    EXPECT_TRUE(verifier.examine(table, rows));
    return table.score;
  };
  EXPECT_EQ(scores(1), scores(3));
}

}  // namespace
}  // namespace trivet::engine

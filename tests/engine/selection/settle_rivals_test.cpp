#include "engine/selection/settle_rivals.hpp"

#include <gtest/gtest.h>

#include <array>

#include "engine/loaded_library/recognizer.hpp"
#include "engine/results/stage_times.hpp"
#include "engine/verification/pose_tester.hpp"
#include "support/rendered_scene.hpp"
#include "support/trained_library.hpp"

namespace trivet::engine {
namespace {

/// Two rods, one with a longer pin, and a scan of the short one.
class SettleRivals : public testing::Test {
 protected:
  static test::Shape rod(float pin) {
    return test::box({-0.1F, -0.03F, -0.02F}, {0.06F, 0.03F, 0.02F})
        .join(test::box({0.06F, -0.01F, -0.01F}, {pin, 0.01F, 0.01F}));
  }
  static Pose pose() { return test::pose_of({0.6F, 0, 0}, {0, 0, 0.7F}); }
  static void SetUpTestSuite() {
    static const test::Shape short_rod = rod(0.085F), long_rod = rod(0.13F);
    static const test::Shape wall = test::box({-1, -1, 1.4F}, {1, 1, 1.5F});
    recognizer_ = Recognizer(test::trained_library({{"long", &long_rod}, {"short", &short_rod}},
                                                   {.tri_spin_images = false}));
    StageTimes times;
    auto scene = prepare_scene(test::render_scan({{&wall, Pose::Identity()}, {&short_rod, pose()}}),
                               {}, times);
    ASSERT_TRUE(scene) << scene.error().message;
    scene_ = std::move(*scene);
  }
  struct Found {
    std::uint32_t model = 0;
    float score = 0;
  };
  /// The settled selection in which the first pose hides the second.
  static Selection settled(const std::array<Found, 2>& found) {
    PoseTable table;
    for (const auto& [model, score] : found)
      table.set_tested(table.add(model, Source::ppf, pose()), {pose(), score, {}});
    Selection selection;
    selection.chosen = {0};
    selection.refused = {{1, Rejection::explained, 0U, 0.9F}};
    const std::array<Row, 2> rows{0, 1};
    const PoseTestOptions test;
    RivalComparisons comparisons(recognizer_, scene_, test);
    EXPECT_TRUE(
        settle_rivals(comparisons, {recognizer_.library(), scene_, table, rows}, selection));
    return selection;
  }
  static constexpr std::uint32_t kLong = 0, kShort = 1;
  static inline Recognizer recognizer_{Library{}};
  static inline PreparedScene scene_;
};

TEST_F(SettleRivals, GivesThePlaceToTheModelThatTheDifferingPixelsSpeakFor) {
  const Selection selection = settled({{{kLong, 0.99F}, {kShort, 0.95F}}});
  EXPECT_EQ(selection.chosen, std::vector<Row>{1});
  ASSERT_EQ(selection.refused.size(), 1U);
  EXPECT_EQ(selection.refused[0].row, 0U);
  EXPECT_EQ(selection.refused[0].explained_by, 1U);
  EXPECT_EQ(selection.refused[0].reason, Rejection::explained);
}

TEST_F(SettleRivals, LeavesThePlaceToOneThatIsBetter) {
  const Selection selection = settled({{{kShort, 0.95F}, {kLong, 0.99F}}});
  EXPECT_EQ(selection.chosen, std::vector<Row>{0});
  EXPECT_EQ(selection.refused[0].row, 1U);
}

TEST_F(SettleRivals, AsksNoneOfLessThanHalfTheScoreNorOfTheSameModel) {
  EXPECT_EQ(settled({{{kLong, 0.99F}, {kShort, 0.4F}}}).chosen[0], 0U);
  EXPECT_EQ(settled({{{kLong, 0.99F}, {kLong, 0.98F}}}).chosen[0], 0U);
}

}  // namespace
}  // namespace trivet::engine

#include "engine/selection/compare_rivals.hpp"

#include <gtest/gtest.h>

#include "engine/loaded_library/recognizer.hpp"
#include "engine/results/stage_times.hpp"
#include "kernels/common/pose_math.hpp"
#include "support/rendered_scene.hpp"
#include "support/trained_library.hpp"

namespace trivet::engine {
namespace {

/// Four steps: one with a post on its back, one with it on its front, and one longer by 3 %; and a
/// bracket.
class CompareRivals : public testing::Test {
 protected:
  static test::Shape step(float end = 0.1F) {
    return test::box({-0.1F, -0.06F, -0.03F}, {end, 0.06F, 0.03F})
        .join(test::box({-0.1F, -0.06F, -0.06F}, {-0.03F, 0.06F, -0.03F}));
  }
  static test::Shape step_with_post(float side) {
    const float low = side < 0 ? -0.06F : 0.03F;
    return step().join(test::box({0.04F, -0.01F, low}, {0.06F, 0.01F, low + 0.03F}));
  }
  /// The camera looks along z: the side of negative z is seen.
  static Pose pose() { return test::pose_of({0.25F, 0.2F, 0}, {0, 0, 0.7F}); }
  static void SetUpTestSuite() {
    static const test::Shape back = step_with_post(1), bracket = test::bracket(),
                             front = step_with_post(-1), longer = step(0.1F + kLonger),
                             plain = step();
    static const test::Shape wall = test::box({-1, -1, 1.4F}, {1, 1, 1.5F});
    recognizer_ = Recognizer(test::trained_library({{"back", &back},
                                                    {"bracket", &bracket},
                                                    {"front", &front},
                                                    {"longer", &longer},
                                                    {"plain", &plain}},
                                                   {.tri_spin_images = false}));
    scene_ = scan_of({{&wall, Pose::Identity()}, {&plain, pose()}});
    scene_of_longer_ = scan_of({{&wall, Pose::Identity()}, {&longer, pose()}});
  }
  static PreparedScene scan_of(const std::vector<test::Placed>& things) {
    StageTimes times;
    auto scene = prepare_scene(test::render_scan(things), {}, times);
    EXPECT_TRUE(scene) << scene.error().message;
    return *std::move(scene);
  }
  static RivalComparison compared(const Rival& first, const Rival& second,
                                  const PreparedScene& scene = scene_) {
    kernels::CompareScratch scratch;
    return *compare_rivals(recognizer_, scene, {}, first, second, scratch);
  }
  /// A pose that is off by a tenth of the tolerance's worth of noise and more.
  static Pose displaced() {
    return kernels::small_motion({0.012F, -0.01F, 0.01F}, {0.001F, 0.0015F, 0.001F},
                                 pose().translation()) *
           pose();
  }
  static constexpr std::uint32_t kBack = 0, kBracket = 1, kFront = 2, kLong = 3, kPlain = 4;
  static constexpr float kLonger = 0.006F;
  static inline Recognizer recognizer_{Library{}};
  static inline PreparedScene scene_, scene_of_longer_;
};

TEST_F(CompareRivals, FindsNothingBetweenModelsThatDifferWhereNothingIsSeen) {
  for (const Pose& at : {pose(), displaced()}) {
    const RivalComparison comparison = compared({kBack, at, 0.9F}, {kPlain, pose(), 0.9F});
    EXPECT_NEAR(comparison.log_odds, 0, 0.1)
        << "the pose of one is off, but that does not speak against its shape";
    EXPECT_EQ(comparison.num_measured, 0U);
  }
}

TEST_F(CompareRivals, DecidesByWhatIsSeenOfTheDifference) {
  for (const Pose& at : {pose(), displaced()}) {
    const RivalComparison comparison = compared({kFront, at, 0.99F}, {kPlain, pose(), 0.9F});
    EXPECT_LT(comparison.log_odds, -4) << "its post is not there";
    EXPECT_GT(comparison.num_measured, 5U);
  }
}

TEST_F(CompareRivals, IsTheNegativeWithBothExchanged) {
  const Rival front{kFront, displaced(), 0.99F}, plain{kPlain, pose(), 0.9F};
  const double forth = compared(front, plain).log_odds, back = compared(plain, front).log_odds;
  EXPECT_NEAR(forth, -back, 0.15 * std::abs(forth));
}

// A model that is too short is found in the middle of what is longer, where a longer one would be
// off by as much at either end.
TEST_F(CompareRivals, TakesEachModelInThePlaceThatSuitsIt) {
  const Pose shifted = pose() * test::pose_of({0, 0, 0}, {kLonger, 0, 0});
  const Rival longer{kLong, pose(), 0.95F}, plain{kPlain, shifted, 0.95F};
  const RivalComparison comparison = compared(longer, plain, scene_of_longer_);
  EXPECT_TRUE(comparison.coincide);
  EXPECT_GT(comparison.log_odds, 10);
  EXPECT_LT(compared(plain, longer, scene_of_longer_).log_odds, -10);
}

TEST_F(CompareRivals, ComparesOtherShapesInTheirOwnPoses) {
  const RivalComparison comparison = compared({kBracket, pose(), 0.6F}, {kPlain, pose(), 0.95F});
  EXPECT_LT(comparison.log_odds, -2);
  EXPECT_LT(comparison.T_second_first.translation().norm(), 1e-6F);
}

}  // namespace
}  // namespace trivet::engine

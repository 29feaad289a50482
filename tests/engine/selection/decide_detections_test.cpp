#include "engine/selection/decide_detections.hpp"

#include <gtest/gtest.h>

#include <array>
#include <utility>

#include "engine/loaded_library/recognizer.hpp"
#include "engine/results/stage_times.hpp"
#include "support/rendered_scene.hpp"
#include "support/trained_library.hpp"

namespace trivet::engine {
namespace {

// Poses are chosen by the pixels that they explain before they are settled, which may move them.
TEST(DecideDetections, GivesAPlaceToOneDetectionAlthoughTwoAreSettledThere) {
  const test::Shape bracket = test::bracket(),
                    box = test::box({-0.1F, -0.1F, 0}, {0.1F, 0.1F, 0.1F});
  const Recognizer recognizer(
      test::trained_library({{"box", &box}, {"bracket", &bracket}}, {.tri_spin_images = false}));
  const Pose pose = test::pose_of({0.6F, -0.4F, 0}, {0, 0, 0.7F});
  StageTimes times;
  const auto scene = prepare_scene(test::render_scan({{&bracket, pose}}), {}, times);
  ASSERT_TRUE(scene) << scene.error().message;

  const auto decided = [&](std::uint32_t pixel_of_closer, float score_of_bracket = 0.99F) {
    PoseTable table;
    const auto add = [&](std::uint32_t model, float score, float mean_square, std::uint32_t pixel) {
      TestedPose tested{pose, score, {}};
      tested.test.examination.mean_square = mean_square;
      tested.test.explained.pixels = {pixel, pixel + 1, pixel + 2};
      table.set_tested(table.add(model, Source::ppf, pose), std::move(tested));
    };
    constexpr std::uint32_t kBox = 0, kBracket = 1;
    add(kBracket, score_of_bracket, 0.9F, 1000);
    add(kBox, 0.9F, 0.5F, 2000);
    add(kBracket, score_of_bracket, 0.01F, pixel_of_closer);  // the first one is settled here
    const std::array<Row, 3> rows{0, 1, 2};
    Selection selection;
    selection.chosen = {0, 1};
    selection.refused = {{2, Rejection::explained, 0U, 0.9F}};
    DecideOptions options;
    options.select.doubtful_score = 0.1F;
    const auto detections = decide_detections(recognizer, *scene, rows, options, selection, table);
    EXPECT_TRUE(detections);
    return std::pair(*detections, table.fate[1]);
  };
  const auto [apart, fate_apart] = decided(3000);
  EXPECT_EQ(apart, (std::vector<Row>{0, 1}));
  EXPECT_EQ(fate_apart, PoseFate::detection);
  const auto [together, fate_together] = decided(2000);
  EXPECT_EQ(together, std::vector<Row>{0});
  EXPECT_EQ(fate_together, PoseFate::explained);
  const auto [beside_doubtful, fate_beside_doubtful] = decided(2000, 0.5F);
  EXPECT_EQ(beside_doubtful, (std::vector<Row>{0, 1})) << "what is not reported takes no place";
  EXPECT_EQ(fate_beside_doubtful, PoseFate::detection);
}

}  // namespace
}  // namespace trivet::engine

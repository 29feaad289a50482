#include "engine/hypotheses/propose_by_votes.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "support/rendered_scene.hpp"
#include "support/trained_library.hpp"

namespace trivet::engine {
namespace {

// Each model that a reference votes for costs as much.
TEST(VoteSource, BoundsThePairsOfReferencesAndModels) {
  const test::Shape lever = test::lever(), bracket = test::bracket();
  const Recognizer recognizer(test::trained_library({{"lever", &lever}, {"bracket", &bracket}}));
  const Pose pose = test::pose_of({0.3F, 0.5F, 0.1F}, {0, 0, 0.9F});
  SceneStats stats;
  const Result<PreparedScene> scene = prepare_scene(
      test::render_scan({{&lever, pose}}), {.viewpoint = Eigen::Vector3d(0, 0, 0)}, stats.times);
  ASSERT_TRUE(scene) << scene.error().message;
  const Library& library = recognizer.library();
  const auto num_references = [&](const ModelGroups& models, std::size_t max_pairs) {
    SceneStats counts;
    VoteSource votes(recognizer, *scene, models, LargePlanes::left_out, counts);
    const auto proposals = votes.propose(models, {.reference_share = 0.5F}, max_pairs, {}, {});
    EXPECT_TRUE(proposals);
    return counts.num_references;
  };
  constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();
  const float step = library.shape(0).quantization.distance_step;
  EXPECT_GT(num_references({{step, {0}}}, kAll), 60U);
  EXPECT_EQ(num_references({{step, {0}}}, kAll), num_references({{step, {0}}}, 100'000));
  EXPECT_EQ(num_references({{step, {0}}}, 60), 60U);
  EXPECT_EQ(num_references({{step, {0, 0}}}, 60), 30U);
  const std::size_t of_two = num_references({{step, {0}}, {2 * step, {1}}}, 60);
  EXPECT_GE(of_two, 60U);
  EXPECT_LE(of_two, 61U) << "each step keeps its share";
}

}  // namespace
}  // namespace trivet::engine

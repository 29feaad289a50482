#include "engine/merge_claims.hpp"

#include <gtest/gtest.h>

#include "support/rendered_scene.hpp"
#include "support/shapes.hpp"
#include "support/trained_library.hpp"

namespace trivet {
namespace {

using Places = std::vector<DetectionPlace>;

/// A claim of the pixels from `first` on, in an image of 100.
PoseClaim claim(float rank, std::uint32_t first, std::uint32_t num_pixels,
                std::optional<std::size_t> detection) {
  PoseClaim out{"part", rank, {}, detection};
  for (std::uint32_t i = 0; i < num_pixels; ++i) out.explained.pixels.push_back(first + i);
  return out;
}

TEST(MergeClaims, KeepsWhatNoBetterOneOfAnyLibraryExplains) {
  const std::vector<SceneClaims> two{
      {{{10, 10}}, {claim(0.9F, 0, 40, 1), claim(0.5F, 60, 20, 0)}},
      {{{10, 10}}, {claim(0.8F, 10, 30, 0), claim(0.7F, 55, 20, 1)}}};
  EXPECT_EQ(*merge_claims(two), (Places{{0, 1}, {1, 1}}));
}

TEST(MergeClaims, LetsPosesHideOthersThatAreNotReported) {
  const std::vector<SceneClaims> two{{{{10, 10}}, {claim(0.9F, 0, 40, {})}},
                                     {{{10, 10}}, {claim(0.8F, 10, 30, 0), claim(0.2F, 90, 5, 1)}}};
  EXPECT_EQ(*merge_claims(two), (Places{{1, 1}}));
}

TEST(MergeClaims, KeepsWhatClaimsNoPixels) {
  const std::vector<SceneClaims> two{{{{10, 10}}, {claim(0.9F, 0, 0, 0)}},
                                     {{{10, 10}}, {claim(0.8F, 0, 0, 0)}}};
  EXPECT_EQ(*merge_claims(two), (Places{{0, 0}, {1, 0}}));
  EXPECT_TRUE(merge_claims({})->empty());
}

TEST(MergeClaims, RefusesOtherImages) {
  const std::vector<SceneClaims> two{{{{10, 10}}, {}}, {{{20, 5}}, {}}};
  EXPECT_FALSE(merge_claims(two));
}

/// The bracket, another part, and a part that looks like the bracket but for its knob and a half
/// of its pillar: it is not there, and found in the bracket's place where it is sought alone.
TEST(MergeClaims, FindsInHalvesOfALibraryWhatTheWholeFinds) {
  const test::Shape bracket = test::bracket(), lever = test::lever();
  test::Shape like = test::box({-0.08F, -0.05F, 0}, {0.08F, 0.05F, 0.02F});
  like.join(test::box({-0.07F, -0.04F, 0.02F}, {-0.03F, 0.01F, 0.11F}));
  like.join(test::box({-0.03F, -0.02F, 0.02F}, {0.05F, -0.005F, 0.06F}));
  const test::Shape wall = test::box({-1, -1, 1.4F}, {1, 1, 1.5F});
  const Cloud scene =
      test::render_scan({{&wall, Pose::Identity()},
                         {&bracket, test::pose_of({2.1F, 0.7F, -0.4F}, {-0.02F, 0.03F, 0.85F})},
                         {&lever, test::pose_of({-0.6F, 0.5F, 1.9F}, {0.12F, 0.02F, 0.95F})}});
  const RecognizeOptions options{.method = Method::ppf, .min_score = 0.5F, .tell_claims = true};
  const auto look = [&](Library library) {
    return recognize(Recognizer(std::move(library)), scene, {}, options);
  };
  const auto whole =
      look(test::trained_library({{"bracket", &bracket}, {"lever", &lever}, {"like", &like}}));
  ASSERT_TRUE(whole) << whole.error().message;
  const std::vector<SceneResult> halves{
      *look(test::trained_library({{"bracket", &bracket}})),
      *look(test::trained_library({{"lever", &lever}, {"like", &like}}))};
  ASSERT_EQ(halves[1].detections.size(), 2U) << "alone, the part that is like another is found";

  const auto merged = merge_claims(std::vector{*halves[0].claims, *halves[1].claims});
  ASSERT_TRUE(merged);
  std::vector<std::string> names;
  for (const auto& [half, d] : *merged) {
    const Detection& detection = halves[half].detections[d];
    names.push_back(detection.model);
    for (const Detection& other : whole->detections) {
      if (other.model != detection.model) continue;
      // Refinement may begin at other hypotheses: it ends within its last step of the same pose, here
      // within 0.03 degrees and 0.02 mm.
      EXPECT_TRUE(other.T_scene_model.isApprox(detection.T_scene_model, 1e-3F))
          << other.T_scene_model.matrix() << "\n"
          << detection.T_scene_model.matrix();
      EXPECT_NEAR(other.score, detection.score, 1e-4F);
    }
  }
  std::ranges::sort(names);
  EXPECT_EQ(names, (std::vector<std::string>{"bracket", "lever"}));
  EXPECT_EQ(whole->detections.size(), 2U);
}

}  // namespace
}  // namespace trivet

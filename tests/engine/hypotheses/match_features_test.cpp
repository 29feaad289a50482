#include "engine/hypotheses/match_features.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/common/thread_limit.hpp"
#include "engine/libraries/index_features.hpp"
#include "engine/results/stage_times.hpp"
#include "kernels/common/pose_math.hpp"
#include "support/random.hpp"
#include "support/rendered_scene.hpp"
#include "support/trained_library.hpp"

namespace trivet::engine {
namespace {

/// Two parts with the same resolution, and a scan of both.
class MatchFeatures : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    static const test::Shape bracket = test::bracket(), lever = test::lever();
    library_ = test::trained_library({{"bracket", &bracket}, {"lever", &lever}});
    levels_ = *index_features(library_);
    ASSERT_EQ(levels_.size(), kFeatureScales.size()) << "both have one resolution";
    const Cloud scan = test::render_scan({{&bracket, truth_[0]}, {&lever, truth_[1]}});
    StageTimes times;
    auto scene = prepare_scene(scan, {}, times);
    ASSERT_TRUE(scene) << scene.error().message;
    scene_ = std::move(*scene);
    sample_ = sample_scene(scene_, levels_[0].resolution, library_.models[0].diameter);
  }

  static SceneMatches match(const MatchOptions& options,
                            std::span<const std::uint8_t> explained = {}) {
    return match_features(library_.basis, levels_[0], {scene_, sample_, explained}, options);
  }
  static bool is_right(std::uint32_t m, const Pose& pose) {
    const ModelInfo& model = library_.models[m];
    const auto distance = kernels::pose_distance(truth_[m], pose, model.symmetry, model.center);
    return distance.translation < 0.1F * model.diameter && distance.rotation_rad < 0.26F;
  }
  static double right_share(const SceneMatches& matches) {
    const auto right = std::ranges::count_if(matches.matches, [](const FeatureMatch& match) {
      return is_right(match.model, match.T_scene_model);
    });
    return static_cast<double>(right) / static_cast<double>(matches.matches.size());
  }
  /// The number of right hypotheses for each model.
  static std::array<std::ptrdiff_t, 2> count_right(const MatchOptions& options) {
    const auto found = hypotheses_of(match(options), scene_, {}, 2, options.grouping);
    std::array<std::ptrdiff_t, 2> right{};
    for (std::uint32_t m = 0; m < 2; ++m) {
      right[m] = std::ranges::count_if(found[m], [&](const kernels::Hypothesis& hypothesis) {
        return is_right(m, hypothesis.T_scene_model);
      });
    }
    return right;
  }

  static inline Library library_;
  static inline FeatureIndex levels_;
  static inline PreparedScene scene_;
  static inline SceneSample sample_;
  static inline const std::array<Pose, 2> truth_{
      test::pose_of({2.1F, 0.7F, -0.4F}, {-0.15F, 0, 0.9F}),
      test::pose_of({-0.6F, 0.5F, 1.9F}, {0.15F, 0, 0.95F})};
};

TEST_F(MatchFeatures, HasTheTruthAmongTheHypothesesOfEachModel) {
  for (const std::ptrdiff_t right : count_right({})) EXPECT_GE(right, 20);
}

TEST_F(MatchFeatures, HasItWithAnyDetectorAndGrouping) {
  for (const Detector detector : {Detector::iss, Detector::harris}) {
    const SceneMatches some = match({.detector = detector});
    EXPECT_LT(some.keypoints.size(), match({}).keypoints.size());
    for (const std::ptrdiff_t right : count_right({.detector = detector})) EXPECT_GE(right, 3);
  }
  for (const Grouping grouping : {Grouping::consistency, Grouping::ransac}) {
    for (const std::ptrdiff_t right : count_right({.max_ratio = 0.95F, .grouping = grouping}))
      EXPECT_GE(right, 1) << static_cast<int>(grouping);
  }
}

TEST_F(MatchFeatures, KeepsWhatIsNearEnough) {
  const SceneMatches all = match({}), near = match({.max_distance = 0.35F});
  EXPECT_LT(near.matches.size(), all.matches.size());
  EXPECT_GT(near.matches.size(), 0U);
  EXPECT_GT(right_share(near), right_share(all));
  EXPECT_EQ(near.keypoints.size(), all.keypoints.size());
}

TEST_F(MatchFeatures, KeepsWhatIsNearerThanTheNextPlace) {
  const SceneMatches nearest = match({.num_neighbors = 1});
  std::size_t before = nearest.matches.size();
  for (const float ratio : {0.95F, 0.85F, 0.7F}) {
    const SceneMatches sure = match({.num_neighbors = 1, .max_ratio = ratio});
    EXPECT_LT(sure.matches.size(), before) << ratio;
    before = sure.matches.size();
  }
  EXPECT_GT(right_share(match({.num_neighbors = 1, .max_ratio = 0.85F})), right_share(nearest));
}

TEST_F(MatchFeatures, GivesSureMatchesMoreVotes) {
  double right = 0, wrong = 0, num_right = 0, num_wrong = 0;
  for (const FeatureMatch& match : match({.num_neighbors = 1, .weigh_by_ratio = true}).matches) {
    ASSERT_GT(match.votes, 0);
    ASSERT_LE(match.votes, 1);
    const bool is_so = is_right(match.model, match.T_scene_model);
    (is_so ? right : wrong) += static_cast<double>(match.votes);
    (is_so ? num_right : num_wrong) += 1;
  }
  EXPECT_GT(right / num_right, wrong / num_wrong);
}

TEST_F(MatchFeatures, DescribesNoMoreThanItMayAndNothingThatIsExplained) {
  EXPECT_LE(match({.max_keypoints = 50}).keypoints.size(), 50U);
  const std::vector<std::uint8_t> explained(scene_.images[0].depth.size(), 1);
  EXPECT_EQ(match({}, explained).keypoints.size(), 0U);
  const SceneMatches all = match({});
  for (const auto& hypotheses : hypotheses_of(all, scene_, explained, 2, Grouping::frames))
    EXPECT_TRUE(hypotheses.empty());
}

TEST_F(MatchFeatures, GivesTheSameBytesForAnyNumberOfThreads) {
  const auto poses = [&](unsigned threads) {
    const ThreadLimit limit(threads);
    std::vector<float> out;
    for (const Grouping grouping : {Grouping::frames, Grouping::consistency, Grouping::ransac}) {
      const MatchOptions options{.max_ratio = 0.95F, .grouping = grouping};
      for (const auto& of_model : hypotheses_of(match(options), scene_, {}, 2, grouping)) {
        for (const kernels::Hypothesis& hypothesis : of_model) {
          const Eigen::Matrix4f pose = hypothesis.T_scene_model.matrix();
          out.insert(out.end(), pose.data(), pose.data() + 16);
        }
      }
    }
    return out;
  };
  EXPECT_EQ(poses(1), poses(2));
}

}  // namespace
}  // namespace trivet::engine

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "engine/common/thread_limit.hpp"
#include "engine/loaded_library/recognizer.hpp"
#include "engine/recognition/recognize.hpp"
#include "kernels/common/pose_math.hpp"
#include "support/rendered_scene.hpp"
#include "support/trained_library.hpp"

namespace trivet::engine {
namespace {

/// A library of similar parts, brackets and levers of many proportions, two of which are in the
/// scan.
class LargeLibrary : public testing::Test {
 protected:
  static constexpr std::size_t kNumShapes = 32;

  static test::Shape stretched(test::Shape shape, const Eigen::Vector3f& by) {
    for (std::size_t i = 0; i < shape.vertices.size(); ++i)
      shape.vertices.set(i, shape.vertices[i].cwiseProduct(by));
    return shape;
  }
  static void SetUpTestSuite() {
    static std::vector<test::Shape> shapes;
    std::vector<std::string> names;
    for (std::size_t k = 0; k < kNumShapes; ++k) {
      const auto step = static_cast<float>(k / 2);
      const Eigen::Vector3f by(1 + 0.15F * std::fmod(step, 4.0F), 1 + 0.2F * std::floor(step / 4),
                               1);
      shapes.push_back(stretched(k % 2 == 0 ? test::bracket() : test::lever(), by));
      names.push_back((k < 10 ? "part_0" : "part_") + std::to_string(k));
    }
    std::vector<std::pair<std::string, const test::Shape*>> named;
    for (std::size_t k = 0; k < kNumShapes; ++k) named.emplace_back(names[k], &shapes[k]);
    recognizer_ = Recognizer(test::trained_library(named));
    static const test::Shape wall = test::box({-1, -1, 1.4F}, {1, 1, 1.5F});
    scan_ = test::render_scan({{&wall, Pose::Identity()},
                               {&shapes[kFirst], first_pose()},
                               {&shapes[kSecond], second_pose()}});
  }
  static Pose first_pose() { return test::pose_of({2.1F, 0.7F, -0.4F}, {-0.12F, 0.03F, 0.8F}); }
  static Pose second_pose() { return test::pose_of({-0.6F, 0.5F, 1.9F}, {0.15F, 0.02F, 0.9F}); }

  static SceneResult found(const RecognizeOptions& options = {}) {
    const auto result = recognize(recognizer_, scan_, {}, options);
    EXPECT_TRUE(result) << result.error().message;
    return *result;
  }
  static void expect_both(const SceneResult& result) {
    ASSERT_EQ(result.detections.size(), 2U);
    for (const Detection& detection : result.detections) {
      const bool first = detection.model == names(kFirst);
      EXPECT_TRUE(first || detection.model == names(kSecond)) << detection.model;
      const auto error = kernels::pose_distance(first ? first_pose() : second_pose(),
                                                detection.T_scene_model, {}, {0, 0, 0});
      EXPECT_LT(error.translation, 0.005F);
      EXPECT_LT(error.rotation_rad, 0.05F);
    }
  }
  static std::string names(std::size_t k) { return recognizer_.library().models[k].name; }

  static constexpr std::size_t kFirst = 6, kSecond = 19;
  static constexpr float kHalf = 0.5F;  // of the usual work: votes for thirty models
  static inline Recognizer recognizer_{Library{}};
  static inline Cloud scan_;
};

// A single test, because each would train the library again.
TEST_F(LargeLibrary, IsSearchedWithinLimitsAndFindsTheVeryModels) {
  const SceneResult within = found({.budget = kHalf});
  expect_both(within);
  const SceneResult all = found({.search = Search::exhaustive});
  expect_both(all);
  EXPECT_LT(4 * within.stats.num_votes, all.stats.num_votes);
  EXPECT_LT(within.stats.num_refined, all.stats.num_refined);

  const SceneResult by_features = found({.method = Method::trisi, .budget = kHalf});
  expect_both(by_features);
  EXPECT_EQ(by_features.stats.num_votes, 0U);

  RecognizeOptions all_but_one{.budget = kHalf};
  for (const ModelInfo& model : recognizer_.library().models) {
    if (model.name != names(kSecond)) all_but_one.models.push_back(model.name);
  }
  for (const Detection& detection : found(all_but_one).detections)
    EXPECT_NE(detection.model, names(kSecond)) << "as a look-alike of another";

  const SceneResult small = found({.budget = 0.1F});
  EXPECT_LT(small.stats.num_refined, within.stats.num_refined);
  EXPECT_LE(small.stats.num_votes, within.stats.num_votes);

  const auto bytes = [](unsigned threads) {
    const ThreadLimit limit(threads);
    std::vector<float> out;
    for (const Detection& detection : found({.budget = kHalf, .min_score = 0.05F}).detections) {
      const Eigen::Matrix4f pose = detection.T_scene_model.matrix();
      out.push_back(detection.score);
      out.insert(out.end(), pose.data(), pose.data() + 16);
    }
    return out;
  };
  EXPECT_EQ(bytes(1), bytes(2));
}

}  // namespace
}  // namespace trivet::engine

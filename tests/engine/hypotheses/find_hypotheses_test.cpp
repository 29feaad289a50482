#include "engine/hypotheses/find_hypotheses.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/results/stage_times.hpp"
#include "engine/training/train.hpp"
#include "kernels/common/pose_math.hpp"
#include "support/rendered_scene.hpp"

namespace trivet {
namespace {

/// Two parts with the same sampling step, and a scan of both.
class FindHypotheses : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    static const test::Shape bracket = test::bracket(), lever = test::lever();
    models_.clear();
    pairs_.clear();
    for (const auto& [name, shape] : {std::pair{"bracket", &bracket}, std::pair{"lever", &lever}}) {
      auto trained = train_model(test::cloud_of(*shape), {name, name, 1, {}}, {});
      ASSERT_TRUE(trained) << trained.error().message;
      models_.push_back(std::move(trained->model));
    }
    for (const Model& model : models_) pairs_.push_back(&model);
    const Cloud scan = test::render_scan({{&bracket, truth_[0]}, {&lever, truth_[1]}});
    StageTimes times;
    auto scene = engine::prepare_scene(scan, {}, times);
    ASSERT_TRUE(scene) << scene.error().message;
    level_ = engine::choose_voters(*scene,
                                   engine::sample_scene(*scene, step(), models_[0].diameter), {});
  }
  static float step() { return models_[0].ppf.quantization.distance_step; }

  static inline std::vector<Model> models_;
  static inline std::vector<const ModelPairs*> pairs_;
  static inline engine::SceneLevel level_;
  static inline const std::array<Pose, 2> truth_{
      test::pose_of({2.1F, 0.7F, -0.4F}, {-0.15F, 0, 0.9F}),
      test::pose_of({-0.6F, 0.5F, 1.9F}, {0.15F, 0, 0.95F})};
};

TEST_F(FindHypotheses, HasTheTruthAmongThoseOfEachModel) {
  ASSERT_EQ(models_[1].ppf.quantization.distance_step, step());
  const auto found = engine::find_hypotheses(pairs_, level_, {}).of_model;
  ASSERT_EQ(found.size(), 2U);
  for (std::size_t m = 0; m < 2; ++m) {
    const Model& model = models_[m];
    const auto right = std::ranges::count_if(found[m], [&](const kernels::Hypothesis& hypothesis) {
      const auto distance =
          kernels::pose_distance(truth_[m], hypothesis.T_scene_model, model.symmetry, model.center);
      return distance.translation < 0.1F * model.diameter && distance.rotation_rad < 0.26F;
    });
    EXPECT_GE(right, 5) << model.name;
  }
}

TEST_F(FindHypotheses, UsesPairsWithinTheBallOnly) {
  for (const float radius : {0.1F, 0.4F, 1.0F}) {
    std::uint32_t bins = 0;
    for (const Model& model : models_)
      bins = std::max(bins, model.ppf.quantization.num_distance_bins);
    const float ball = step() * std::ceil(radius * static_cast<float>(bins));
    std::uint64_t expected = 0;
    for (const std::uint32_t r : level_.references) {
      for (std::size_t i = 0; i < level_.points.size(); ++i)
        expected += (level_.points[i] - level_.points[r]).squaredNorm() <= ball * ball;
    }
    const engine::VotedHypotheses voted =
        engine::find_hypotheses(pairs_, level_, {.radius = radius});
    EXPECT_NEAR(static_cast<double>(voted.num_pairs), static_cast<double>(expected), 3) << radius;
  }
}

TEST_F(FindHypotheses, FindsNothingWithoutPoints) {
  for (const auto& found : engine::find_hypotheses(pairs_, {}, {}).of_model)
    EXPECT_TRUE(found.empty());
}

}  // namespace
}  // namespace trivet

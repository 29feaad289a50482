#include "engine/training/describe_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/common/thread_limit.hpp"
#include "engine/results/stage_times.hpp"
#include "engine/training/train.hpp"
#include "kernels/common/voxel_hash.hpp"
#include "support/random.hpp"
#include "support/rendered_scene.hpp"

namespace trivet::engine {
namespace {

SurveyedModel surveyed(const test::Shape& shape) {
  StageTimes times;
  auto model = survey_model(test::cloud_of(shape), {"part", "part.ply", 1, {}},
                            TrainOptions{}.num_samples, times);
  EXPECT_TRUE(model) << model.error().message;
  return std::move(*model);
}

TEST(ResolutionFor, IsOneForModelsOfLikeSizeAndNearAnEightiethOfTheDiameter) {
  EXPECT_EQ(resolution_for(0.2F), resolution_for(0.21F));
  for (const float diameter : {0.003F, 0.1F, 0.2F, 1.7F, 250.0F}) {
    EXPECT_NEAR(std::log2(resolution_for(diameter) / (0.0125F * diameter)), 0, 0.2501F);
    EXPECT_NEAR(resolution_for(4 * diameter), 4 * resolution_for(diameter), 1e-5F * diameter);
  }
}

TEST(DescribeModel, DescribesTheVisibleSurfaceFromManySides) {
  const SurveyedModel model = surveyed(test::bracket());
  const PointsView visible = model.samples.points;
  const Descriptions all = describe_model(model, {});
  const kernels::VoxelHash samples(visible, 0.02F);
  std::size_t near = 0;
  for (std::size_t i = 0; i < all.size(); ++i)
    near += samples.nearest(all.keypoints[i], 0.01F).has_value();
  EXPECT_GT(near, all.size() * 98 / 100) << "on the surface";
  const kernels::VoxelHash keypoints(all.keypoints, 0.02F);
  std::size_t covered = 0, most = 0;
  for (std::size_t i = 0; i < visible.size(); ++i) {
    const std::size_t around = keypoints.count_within(visible[i], 0.02F);
    covered += around > 0;
    most = std::max(most, around);
  }
  EXPECT_GT(covered, visible.size() * 95 / 100);
  EXPECT_GT(most, 100U) << "as several views show them";
}

TEST(DescribeModel, GivesEachDescriptionOfAKeypointOnce) {
  const Descriptions all = describe_model(surveyed(test::lever()), {});
  const kernels::VoxelHash keypoints(all.keypoints, 0.01F);
  std::size_t pairs = 0;
  for (std::uint32_t i = 0; i < all.size(); i += 5) {
    keypoints.visit_within(all.keypoints[i], 0, [&](std::uint32_t k, float) {
      if (k == i) return;
      ++pairs;
      double squared = 0;
      for (std::size_t c = 0; c < kernels::kTriSpinSize; ++c) {
        squared += std::pow(
            all.images[i * kernels::kTriSpinSize + c] - all.images[k * kernels::kTriSpinSize + c],
            2);
      }
      EXPECT_TRUE(squared > 0.0899 || (all.frames[i] - all.frames[k]).norm() > 0.2499F);
    });
  }
  EXPECT_GT(pairs, 100U);
}

TEST(DescribeModel, GivesFiveDescriptionsOfAKeypointAtTheMost) {
  const Descriptions all = describe_model(surveyed(test::lever()), {});
  const kernels::VoxelHash keypoints(all.keypoints, 0.01F);
  std::uint32_t most = 0;
  for (std::uint32_t i = 0; i < all.size(); ++i)
    most = std::max(most, keypoints.count_within(all.keypoints[i], 0));
  EXPECT_EQ(most, 5U);
}

TEST(DescribeModel, DescribesOneInSoManyKeypoints) {
  const SurveyedModel model = surveyed(test::lever());
  const auto n = static_cast<double>(describe_model(model, {}).size());
  EXPECT_NEAR(static_cast<double>(describe_model(model, {.stride = 8}).size()), n / 8, n / 50);
}

TEST(DescribeModel, GivesTheSameBytesForAnyNumberOfThreads) {
  const SurveyedModel model = surveyed(test::lever());
  const auto with_threads = [&](unsigned n) {
    const ThreadLimit limit(n);
    return describe_model(model, {});
  };
  const Descriptions one = with_threads(1), two = with_threads(2);
  EXPECT_TRUE(test::same_bits(one.images, two.images));
  EXPECT_TRUE(test::same_bits(one.keypoints, two.keypoints));
}

}  // namespace
}  // namespace trivet::engine

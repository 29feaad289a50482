// From spin images to the codes stored in a library.
#include "engine/training/find_basis.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "engine/training/describe_model.hpp"
#include "engine/training/encode_features.hpp"
#include "kernels/common/projector.hpp"
#include "kernels/spin_images/feature_codes.hpp"
#include "support/random.hpp"
#include "support/rendered_scene.hpp"

namespace trivet::engine {
namespace {

const ModelSource kLever{"lever", "lever.ply", 1, {}};

std::vector<float> lever_images(std::size_t wanted) {
  const auto images = sample_images(test::cloud_of(test::lever()), kLever, wanted);
  EXPECT_TRUE(images) << images.error().message;
  return *images;
}

TEST(SampleImages, GivesAsManyAsAreWanted) {
  EXPECT_EQ(lever_images(50).size(), 50 * kernels::kTriSpinSize);
  EXPECT_GT(lever_images(100'000).size(), 250 * kernels::kTriSpinSize) << "all there are";
}

TEST(BasisOf, KeepsComponentsByNumber) {
  const std::vector<float> images = lever_images(1000);
  EXPECT_EQ(basis_of(images, 60).components.size(), 60U);
  EXPECT_EQ(basis_of(images, 1).components.size(), 1U);
  EXPECT_EQ(basis_of({}, 60).components.size(), 0U);
}

// A distance between codes equals the distance between projected images, up to rounding.
TEST(EncodeFeatures, KeepsDistances) {
  StageTimes times;
  const auto model =
      survey_model(test::cloud_of(test::lever()), kLever, TrainOptions{}.num_samples, times);
  ASSERT_TRUE(model);
  const Descriptions all = describe_model(*model, {.stride = 4});
  const TriSpinBasis basis = basis_of(all.images, 60);
  const kernels::Projector projector(basis.components);
  const std::array parts{encode_features(all, projector, basis.code_step)};
  const TriSpinFeatures features = join_features(parts, basis, 0.01F);
  ASSERT_EQ(features.size(), all.size());
  ASSERT_EQ(features.codes.size(), 60 * all.size());
  std::vector<float> exact(features.codes.size()), coded(features.codes.size());
  projector.project(all.images, exact);
  kernels::decode(features.codes, basis.code_step, coded);
  const auto distance = [&](const std::vector<float>& of, std::size_t i, std::size_t j) {
    double squared = 0;
    for (std::size_t k = 0; k < 60; ++k) squared += std::pow(of[60 * i + k] - of[60 * j + k], 2);
    return std::sqrt(squared);
  };
  for (std::size_t i = 1; i < all.size(); ++i)
    EXPECT_NEAR(distance(coded, i - 1, i), distance(exact, i - 1, i), 0.03);
  for (std::size_t i = 0; i < all.size(); i += 50) {
    const Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>> frame(
        features.frames[i].data());
    EXPECT_EQ(frame, all.frames[i]);
  }
}

}  // namespace
}  // namespace trivet::engine

#include "kernels/spin_images/spin_image.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "support/allocations.hpp"
#include "support/random.hpp"
#include "support/reference_descriptor.hpp"
#include "support/support_of.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;
using test::support_of;
using Image = std::array<float, kSpinImageSize>;

constexpr float kRadius = 0.6F;

Image image_of(const Support& support, const Vector3f& axis, float radius = kRadius) {
  Image image;
  SpinScratch scratch;
  spin_image(support, axis, radius, image, scratch);
  return image;
}

double distance(const Image& a, const Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow(a[i] - b[i], 2);
  return std::sqrt(sum);
}

TEST(SpinImage, AgreesWithANaiveReference) {
  for (const std::size_t n : test::kSmallSizes) {
    test::Random random(n);
    const Points points = random.surface(n);
    std::vector<float> areas(n);
    for (float& area : areas) area = random.uniform(0, 2);
    const Support support = support_of(points, kRadius, {0.1F, 0, 0}, areas);
    const Vector3f axis = random.direction();
    const Image image = image_of(support, axis);
    const auto expected =
        reference::spin_image(reference::points_of(support), axis.cast<double>(), kRadius);
    for (std::size_t i = 0; i < kSpinImageSize; ++i)
      EXPECT_NEAR(image[i], expected[i], 2e-3 + 1e-4 * expected[i]) << n << ' ' << i;
  }
}

TEST(SpinImage, HoldsTheAreaOfTheSupport) {
  test::Random random;
  const Support support = support_of(random.surface(700), kRadius);
  const Image image = image_of(support, {0, 0, 1});
  EXPECT_NEAR(std::accumulate(image.begin(), image.end(), 0.0), static_cast<double>(support.size),
              0.01);
}

// Points on the border of the support, at its poles and at its center all fall in the image.
TEST(SpinImage, HoldsPointsOnTheBorder) {
  Points points;
  for (const Vector3f& p : {Vector3f(0, 0, kRadius), Vector3f(0, 0, -kRadius),
                            Vector3f(kRadius, 0, 0), Vector3f(0, 0, 0)})
    points.push_back(p);
  const Image image = image_of(support_of(points, kRadius), {0, 0, 1});
  EXPECT_NEAR(image[0], 1, 1e-5F);
  EXPECT_NEAR(image[(kSpinBins - 1) * kSpinBins], 1, 1e-5F);
  EXPECT_NEAR(image[kSpinBins / 2 * kSpinBins + kSpinBins - 1], 1, 1e-5F);
  EXPECT_NEAR(image[kSpinBins / 2 * kSpinBins], 1, 1e-5F);
}

TEST(SpinImage, IsTheSameAfterMotionsTurnsAboutTheAxisAndScaling) {
  test::Random random;
  const Points points = random.surface(400);
  const Vector3f keypoint(0.2F, -0.1F, 0), axis = random.direction();
  const Image here = image_of(support_of(points, kRadius, keypoint), axis);
  const Pose motion = random.motion();
  const float scale = 50;
  const Points moved =
      test::transformed(points, scale * motion.linear(), scale * motion.translation());
  const Image there = image_of(support_of(moved, scale * kRadius, scale * (motion * keypoint)),
                               motion.linear() * axis, scale * kRadius);
  EXPECT_LT(distance(here, there), 0.05);
  const Eigen::Matrix3f turn = Eigen::AngleAxisf(1.1F, axis).toRotationMatrix();
  const Points turned = test::transformed(points, turn, keypoint - turn * keypoint);
  EXPECT_LT(distance(here, image_of(support_of(turned, kRadius, keypoint), axis)), 0.05);
  const Vector3f other = axis.unitOrthogonal();
  EXPECT_GT(distance(here, image_of(support_of(points, kRadius, keypoint), other)), 10);
}

TEST(SpinImage, NormalizedDoesNotDependOnTheDensity) {
  test::Random random;
  const auto image = [&](std::size_t n) {
    Image out = image_of(support_of(random.surface(n), kRadius), {0, 0, 1});
    normalize_spin_image(out);
    double squares = 0;
    for (const float value : out)
      squares += static_cast<double>(value) * static_cast<double>(value);
    EXPECT_NEAR(squares, 1, 1e-5);
    return out;
  };
  EXPECT_LT(distance(image(40000), image(10000)), 0.08);
  Image empty{};
  normalize_spin_image(empty);
  EXPECT_EQ(distance(empty, Image{}), 0);
}

TEST(SpinImage, AllocatesOnce) {
  test::Random random;
  const Support support = support_of(random.surface(500), kRadius);
  SpinScratch scratch;
  Image image;
  spin_image(support, {0, 0, 1}, kRadius, image, scratch);
  EXPECT_EQ(test::allocations_in([&] {
              spin_image(support, {1, 0, 0}, kRadius, image, scratch);
            }),
            0U);
}

}  // namespace
}  // namespace trivet::kernels

#include "engine/training/orient_by_samples.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/random.hpp"

namespace trivet::engine {
namespace {

using Eigen::Vector3f;

constexpr float kSpacing = 0.05F, kThickness = 0.01F;
const Vector3f kUp = Vector3f::UnitZ();

/// A plate thinner than its sample spacing: the upper samples at 0, the lower ones at -kThickness,
/// visible or not.
struct Plate {
  Points samples;
  Normals normals;
  std::vector<ViewMask> views;

  Plate(bool visible_above, bool visible_below) {
    for (int i = -10; i <= 10; ++i) {
      for (int j = -10; j <= 10; ++j) {
        const Vector3f at(static_cast<float>(i) * kSpacing, static_cast<float>(j) * kSpacing, 0);
        samples.push_back(at);
        normals.push_back(kUp);
        views.push_back(visible_above ? ViewMask{1} : ViewMask{});
        samples.push_back(at + Vector3f(0.5F * kSpacing, 0.5F * kSpacing, -kThickness));
        normals.push_back(-kUp);
        views.push_back(visible_below ? ViewMask{1} : ViewMask{});
      }
    }
  }

  void hide(const Points& points, Normals& of) const {
    hide_by_samples(samples, normals, views, kSpacing, points, of);
  }
};

/// Positions on the upper side.
Points places(std::size_t n) {
  test::Random random(3);
  Points points;
  for (std::size_t i = 0; i < n; ++i)
    points.push_back({random.uniform(-0.4F, 0.4F), random.uniform(-0.4F, 0.4F), 0});
  return points;
}

std::size_t count_hidden(NormalsView normals) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < normals.size(); ++i) count += normals[i].allFinite() ? 0 : 1;
  return count;
}

TEST(OrientBySamples, TurnsNormalsToTheSideOfTheNearestSample) {
  Points samples;
  Normals outward;
  for (int i = 0; i < 200; ++i) {  // of a ball
    const float z = 1 - (static_cast<float>(i) + 0.5F) / 100, r = std::sqrt(1 - z * z);
    const float turn = 2.4F * static_cast<float>(i);
    samples.push_back({r * std::cos(turn), r * std::sin(turn), z});
    outward.push_back(samples[samples.size() - 1]);
  }
  test::Random random(1);
  Points points;
  Normals normals;
  for (int i = 0; i < 500; ++i) {
    points.push_back(random.direction());
    normals.push_back(i % 2 == 0 ? points[points.size() - 1]
                                 : Vector3f(-points[points.size() - 1]));
  }
  points.push_back({9, 9, 9});
  normals.push_back(kUp);
  orient_by_samples(samples, outward, {}, 0.25F, points, normals);
  for (std::size_t i = 0; i < 500; ++i) EXPECT_GT(normals[i].dot(points[i]), 0.99F);
  EXPECT_FALSE(normals[500].allFinite()) << "far from all samples";
}

TEST(HideBySamples, AsksTheSideOfAThinWallThatAPointIsOn) {
  const Points points = places(500);
  Normals normals;
  for (std::size_t i = 0; i < points.size(); ++i) normals.push_back(kUp);
  Plate(true, false).hide(points, normals);
  EXPECT_EQ(count_hidden(normals), 0U);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(normals[i], kUp);
  Plate(false, true).hide(points, normals);
  EXPECT_EQ(count_hidden(normals), points.size());
}

TEST(HideBySamples, LeavesPointsWithSamplesOfOneOtherDirectionAlone) {
  const Points points = places(100);
  Normals normals;
  for (std::size_t i = 0; i < points.size(); ++i) normals.push_back(Vector3f::UnitX());
  Plate(true, true).hide(points, normals);
  EXPECT_EQ(count_hidden(normals), 0U);
}

}  // namespace
}  // namespace trivet::engine

#include "kernels/verification/compare_turns.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "kernels/symmetry/turn_axis.hpp"
#include "support/random.hpp"
#include "support/ray_image.hpp"
#include "support/rendered_scene.hpp"
#include "support/sampled_shape.hpp"
#include "support/shapes.hpp"

namespace trivet::kernels {
namespace {

constexpr float kDegree = std::numbers::pi_v<float> / 180;
constexpr float kNear = 12 * kDegree;
constexpr float kFull = 360 * kDegree;
constexpr float kNoise = 0.001F;
constexpr MeasurementErrors kErrors{kNoise, 3};
const Symmetry::Axis kAxis{{0, 0, 1}, {0, 0, 0}};

/// A drum with knobs on its rim.
struct Drum {
  test::Shape shape = test::prism(60, test::circle(0.08), -0.02, 0.02);
  RayScene surface;
  test::SampledShape sampled;

  explicit Drum(int knobs) : surface(with_knobs(knobs)) {
    sampled = test::sample_shape(shape.vertices, shape.triangles);
  }
  RayScene with_knobs(int knobs) {
    for (int k = 0; k < knobs; ++k) {
      shape.join(
          test::box({0.055F, -0.01F, 0.02F}, {0.075F, 0.01F, 0.032F})
              .moved(turn_about(kAxis, kFull * static_cast<float>(k) / static_cast<float>(knobs))));
    }
    return *RayScene::from_mesh(shape.vertices, shape.triangles);
  }

  RangeImage render(const Pose& pose) const {
    const ImageGeometry camera{Pose::Identity(), 150, 150, 79.5F, 59.5F, 160, 120};
    RangeImage image = test::measure(camera, surface, {&pose, 1}, 1.5F);
    test::Random random(7);
    for (float& depth : image.depth) depth += random.normal(kNoise);
    return image;
  }
  TurnComparison compare(const RangeImage& image, const Pose& pose, float period) const {
    CompareScratch scratch;
    return compare_turns({&image, 1}, {surface, sampled.view(), pose}, {kAxis, period, kNear},
                         kErrors, {.tolerance = 0.003F, .plane_is_background = {}}, scratch);
  }
  double log_ratio(const RangeImage& image, const Pose& pose, float angle) const {
    CompareScratch scratch;
    const ModelSamples samples = sampled.view();
    const Pose turned = pose * turn_about(kAxis, angle);
    return compare_poses({&image, 1}, {surface, samples, turned}, {surface, samples, pose}, kErrors,
                         {.tolerance = 0.003F, .plane_is_background = {}}, scratch)
        .log_ratio;
  }
};

const Pose kFacing =
    test::pose_of({2.5F, 0.2F, 0}, {0.02F, -0.01F, 0.5F});  // knobs towards the camera
const Pose kAway = test::pose_of({0.4F, 0.1F, 0}, {0.02F, -0.01F, 0.5F});

float apart(float a, float b, float period) { return std::abs(std::remainder(a - b, period)); }

TEST(CompareTurns, FindsTheTurnThatTheScanShows) {
  const Drum drum(1);
  const RangeImage image = drum.render(kFacing);
  for (const float off : {0.0F, 3.0F, 50.0F, 181.0F, 333.0F}) {
    const Pose pose = kFacing * turn_about(kAxis, off * kDegree);
    const TurnComparison turns = drum.compare(image, pose, kFull);
    EXPECT_LT(apart(turns.best, -off * kDegree, kFull), 1.5F * kDegree) << off;
    EXPECT_GT(turns.share, 0.99F) << off;
    EXPECT_TRUE(turns.others.empty()) << off;
  }
}

TEST(CompareTurns, ComparesOnePeriod) {
  const Drum drum(3);
  const RangeImage image = drum.render(kFacing);
  const TurnComparison turns = drum.compare(image, kFacing * turn_about(kAxis, 1.2F), kFull / 3);
  EXPECT_LT(apart(turns.best, -1.2F, kFull / 3), 1.5F * kDegree);
  EXPECT_LT(std::abs(turns.best), kFull / 3);
  EXPECT_GT(turns.share, 0.99F);
  const TurnComparison all = drum.compare(image, kFacing, kFull);
  EXPECT_NEAR(all.share, 1.0F / 3, 0.2F) << "three turns are as good";
}

TEST(CompareTurns, SharesTheLikelihoodAmongSimilarTurns) {
  const Drum drum(1);
  const TurnComparison turns = drum.compare(drum.render(kAway), kAway, kFull);
  EXPECT_LT(turns.share, 0.2F) << "the knob is behind";
  EXPECT_GE(turns.others.size(), 8U);
  for (std::size_t i = 0; i < turns.others.size(); ++i) {
    EXPECT_GE(apart(turns.others[i], turns.best, kFull), kNear - 1e-5F);
    for (std::size_t k = 0; k < i; ++k)
      EXPECT_GE(apart(turns.others[i], turns.others[k], kFull), kNear - 1e-5F);
  }
}

/// An occluder in front of the camera hides the part of the drum's top between two directions from
/// its center.
RangeImage hide(RangeImage image, const Pose& pose, float from, float to) {
  const Pose T_drum_camera = pose.inverse();
  for (std::size_t pixel = 0; pixel < image.depth.size(); ++pixel) {
    const Eigen::Vector3f eye = T_drum_camera.translation();
    const Eigen::Vector3f ray = T_drum_camera.linear() * image.geometry.back_project(pixel, 1);
    const Eigen::Vector3f p = eye + (0.026F - eye.z()) / ray.z() * ray;
    const float direction = std::atan2(p.y(), p.x());
    if (direction > from && direction < to) image.depth[pixel] = 0.3F;
  }
  return image;
}

// The knob is known to be behind the cover, which is three times as wide, but not where.
TEST(CompareTurns, ChoosesTheMiddleOfSimilarTurnsAndReportsTheirEnds) {
  const Drum drum(1);
  constexpr float kHalf = 50 * kDegree, kKnob = 9 * kDegree;
  for (const float knob : {-25.0F, 0.0F, 30.0F}) {
    const Pose truth = kFacing * turn_about(kAxis, knob * kDegree);
    const RangeImage image = hide(drum.render(truth), kFacing, -kHalf, kHalf);
    for (const float off : {0.0F, 2.3F}) {
      const TurnComparison turns =
          drum.compare(image, kFacing * turn_about(kAxis, off * kDegree), kFull);
      EXPECT_LT(apart(turns.best, -off * kDegree, kFull), 6 * kDegree) << knob;
      EXPECT_LT(apart(turns.low, -kHalf + kKnob - off * kDegree, kFull), 10 * kDegree) << knob;
      EXPECT_LT(apart(turns.high, kHalf - kKnob - off * kDegree, kFull), 10 * kDegree) << knob;
      EXPECT_LE(turns.low, turns.best);
      EXPECT_GE(turns.high, turns.best);
    }
  }
}

TEST(CompareTurns, KeepsThePoseWhereAllTurnsAreAlike) {
  const Drum drum(1);
  RangeImage image = drum.render(kFacing);
  for (float& depth : image.depth) depth = 0.3F;  // hidden altogether
  for (const float period : {kFull, kFull / 3}) {
    const TurnComparison turns = drum.compare(image, kFacing, period);
    EXPECT_EQ(turns.best, 0);
    EXPECT_FLOAT_EQ(turns.low, -0.5F * period);
    EXPECT_FLOAT_EQ(turns.high, 0.5F * period);
    EXPECT_NEAR(turns.share, 2 * kNear / period, 0.05F);
  }
}

TEST(CompareTurns, AgreesWithASearchOfAllTurns) {
  const Drum drum(2);
  const Pose hidden = test::pose_of({1.4F, 0.6F, 0}, {0.02F, -0.01F, 0.5F});
  const RangeImage image = drum.render(hidden);
  const Pose pose = hidden * turn_about(kAxis, 0.7F);
  const TurnComparison turns = drum.compare(image, pose, kFull / 2);
  double best = 0, all = 0, close = 0;
  for (int k = 0; k < 360; ++k) {
    const float angle = 0.5F * kDegree * static_cast<float>(k);
    const double log = drum.log_ratio(image, pose, angle);
    best = std::max(best, log);
    all += std::exp(log);
    if (apart(angle, turns.best, kFull / 2) < kNear) close += std::exp(log);
  }
  EXPECT_NEAR(drum.log_ratio(image, pose, turns.best), best, 2);
  EXPECT_NEAR(turns.share, close / all, 0.1);
}

}  // namespace
}  // namespace trivet::kernels

#include "kernels/verification/refine_pose.hpp"

#include <gtest/gtest.h>

#include <array>

#include "support/allocations.hpp"
#include "support/analytic_scene.hpp"
#include "support/random.hpp"
#include "support/reference_ppf.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;
using test::PlacedSurface;
using test::Random;

constexpr double kDegree = reference::kPi / 180;

/// A box with a cut corner, 1.3 wide and 3 away, that shows three faces and the cut to the camera.
struct BoxScene {
  test::Solid solid = test::cut_box();
  test::SampledModel model = test::sampled_solid(solid, 0.03F, 0.66F);
  Pose T_camera_scene = test::placed({0.4F, -0.3F, 1}, {0.3F, 0.5F, -0.2F});
  Pose in_camera = test::placed({0.1F, -0.05F, 3}, {2.4F, -0.7F, 0.4F});
  Pose truth = T_camera_scene.inverse() * in_camera;
  RefineOptions options;

  BoxScene() {
    options.num_samples = 500;
    options.first_gate = 0.1F;
    options.last_gate = 0.02F;
    options.max_translation = 0.13F;
  }
  /// Keeps the samples that stay on their face under any motion of 0.02.
  void keep_off_edges() {
    test::SampledModel inner;
    for (std::size_t i = 0; i < model.points.size(); ++i) {
      const auto near = std::ranges::count_if(solid, [&](const test::HalfSpace& face) {
        return face.offset - face.normal.dot(model.points[i].cast<double>()) < 0.04;
      });
      if (near == 1) inner.add(model.points[i], model.normals[i]);
    }
    inner.spacing = model.spacing;
    inner.diameter = model.diameter;
    model = std::move(inner);
  }
  RangeImage see(const std::vector<PlacedSurface>& more = {}) const {
    std::vector<PlacedSurface> surfaces{{test::moved(test::boundary(solid), in_camera)}};
    surfaces.insert(surfaces.end(), more.begin(), more.end());
    return test::render({T_camera_scene, 400, 400, 159.5F, 119.5F, 320, 240}, surfaces);
  }
  Refined refine(const RangeImage& image, const Pose& start) const {
    return refine_pose({&image, 1}, model.view(), start, options);
  }
  /// The pose after a rotation and a shift of the center, each in a random direction.
  Pose off(Random& random, double angle, float shift) const {
    Pose pose = truth * test::placed({0, 0, 0}, static_cast<float>(angle) * random.direction());
    pose.pretranslate(shift * random.direction());
    return pose;
  }
};

double turned(const Pose& a, const Pose& b) { return reference::rotation_angle(a, b); }
float shifted(const Pose& a, const Pose& b) { return (a.translation() - b.translation()).norm(); }

TEST(RefinePose, ConvergesFromFiveDegreesAndThreePercentOff) {
  const BoxScene scene;
  const RangeImage image = scene.see({test::wall(4)});
  for (std::uint64_t trial = 0; trial < 50; ++trial) {
    Random random(trial);
    const Pose start = scene.off(random, 5 * kDegree, 0.04F);
    const Refined refined = scene.refine(image, start);
    EXPECT_FALSE(refined.moved_too_far) << trial;
    // A pixel is 0.0075 wide; residuals across planes do not depend on the pixel of the
    // correspondence.
    EXPECT_LT(turned(refined.T_scene_model, scene.truth), 0.1 * kDegree) << trial;
    EXPECT_LT(shifted(refined.T_scene_model, scene.truth), 1e-3F) << trial;
  }
}

TEST(RefinePose, StaysAtTheTruePose) {
  BoxScene scene;
  const RangeImage image = scene.see();
  const Refined nearly = scene.refine(image, scene.truth);  // an edge pixel may show the next face
  EXPECT_LT(turned(nearly.T_scene_model, scene.truth), 0.02 * kDegree);
  EXPECT_LT(shifted(nearly.T_scene_model, scene.truth), 1e-4F);
  EXPECT_EQ(nearly.iterations, scene.options.max_iterations);
  scene.keep_off_edges();
  const Pose refined = scene.refine(image, scene.truth).T_scene_model;
  EXPECT_LT(turned(refined, scene.truth), 1e-3 * kDegree);
  EXPECT_LT(shifted(refined, scene.truth), 1e-5F);
}

// Checks the Jacobian by central differences: one step from a small motion either way undoes it. A
// wrong column would leave part of the motion.
TEST(RefinePose, UndoesASmallMotionInOneStep) {
  BoxScene scene;
  scene.keep_off_edges();
  scene.options.max_iterations = 1;
  const RangeImage image = scene.see();
  constexpr float kStep = 0.004F;
  for (int component = 0; component < 6; ++component) {
    const auto from = [&](float step) {
      Vector3f w = Vector3f::Zero(), t = Vector3f::Zero();
      (component < 3 ? w : t)[component % 3] = step;
      return scene.refine(image, scene.truth * test::placed(t, w)).T_scene_model;
    };
    // The damping reduces the step by a thousandth of the mean stiffness, a larger share of a weak
    // direction.
    const Pose plus = from(kStep), minus = from(-kStep);
    EXPECT_LT(turned(plus, minus), 0.05F * 2 * kStep) << component;
    EXPECT_LT(shifted(plus, minus), 0.05F * 2 * kStep) << component;
  }
}

TEST(RefinePose, IgnoresWhatHidesTheModelInPart) {
  const BoxScene scene;
  const RangeImage image = scene.see({test::left_half(2.2), test::wall(3.6)});
  for (std::uint64_t trial = 0; trial < 20; ++trial) {
    Random random(trial);
    const Refined refined = scene.refine(image, scene.off(random, 3 * kDegree, 0.02F));
    EXPECT_LT(turned(refined.T_scene_model, scene.truth), 0.3 * kDegree) << trial;
    EXPECT_LT(shifted(refined.T_scene_model, scene.truth), 4e-3F) << trial;
  }
}

TEST(RefinePose, IsNotDrawnByBackgroundPlanes) {
  BoxScene scene;
  Random random(5);
  const Pose start = scene.off(random, 3 * kDegree, 0.02F);
  RangeImage image = scene.see();
  std::ranges::fill(image.plane, std::uint8_t{2});
  const std::array<std::uint8_t, 2> first{1, 0}, second{0, 1};
  scene.options.plane_is_background = first;
  EXPECT_GT(scene.refine(image, start).iterations, 0);
  scene.options.plane_is_background = second;
  const Refined refined = scene.refine(image, start);
  EXPECT_EQ(refined.iterations, 0) << "nothing else is measured";
  EXPECT_EQ(refined.T_scene_model.matrix(), start.matrix());
}

TEST(RefinePose, BearsNoise) {
  const BoxScene scene;
  RangeImage image = scene.see();
  Random random;
  for (float& depth : image.depth) depth += depth > 0 ? random.normal(0.005F) : 0;
  const Refined refined = scene.refine(image, scene.off(random, 4 * kDegree, 0.03F));
  EXPECT_LT(turned(refined.T_scene_model, scene.truth), 0.3 * kDegree);
  EXPECT_LT(shifted(refined.T_scene_model, scene.truth), 2e-3F);
}

TEST(RefinePose, UsesAllImages) {
  const BoxScene scene;
  // Two views, from the front and from the right; each sees other faces.
  const Pose around = test::placed({0, 0, 3}, {0, 1.2F, 0}) * test::placed({0, 0, -3});
  BoxScene side = scene;
  side.T_camera_scene = around * scene.T_camera_scene;
  side.in_camera = around * scene.in_camera;
  const std::array images{scene.see(), side.see()};
  Random random;
  const Pose start = scene.off(random, 4 * kDegree, 0.03F);
  const Pose refined = refine_pose(images, scene.model.view(), start, scene.options).T_scene_model;
  EXPECT_LT(turned(refined, scene.truth), 0.05 * kDegree);
  EXPECT_LT(shifted(refined, scene.truth), 5e-4F);
}

TEST(RefinePose, GivesUpWhenItMovedTooFar) {
  BoxScene scene;
  const RangeImage image = scene.see();
  Random random;
  const Pose start = scene.off(random, 4 * kDegree, 0.04F);
  scene.options.max_translation = 0.01F;
  const Refined shift = scene.refine(image, start);
  EXPECT_TRUE(shift.moved_too_far);
  EXPECT_EQ(shift.T_scene_model.matrix(), start.matrix());
  scene.options.max_translation = 0.13F;
  scene.options.max_rotation_rad = 0.02F;
  const Refined turn = scene.refine(image, start);
  EXPECT_TRUE(turn.moved_too_far);
  EXPECT_EQ(turn.T_scene_model.matrix(), start.matrix());
}

TEST(RefinePose, StaysWhereThereIsTooLittleToHoldOnTo) {
  BoxScene scene;
  RangeImage image = scene.see();
  const Pose away = test::placed({5, 5, 5}) * scene.truth;
  EXPECT_EQ(scene.refine(image, away).T_scene_model.matrix(), away.matrix());
  image.depth.assign(image.depth.size(), 0);
  const Refined blind = scene.refine(image, scene.truth);
  EXPECT_EQ(blind.T_scene_model.matrix(), scene.truth.matrix());
  EXPECT_EQ(blind.iterations, 0);
  EXPECT_FALSE(blind.moved_too_far);
  scene.options.num_samples = 30;  // some 12 face the camera
  EXPECT_EQ(scene.refine(scene.see(), scene.truth).iterations, 0);
}

// A plate on a wall can slide and rotate in its plane: those directions must not diverge.
TEST(RefinePose, HoldsDirectionsThatAPlaneDoesNotFix) {
  const test::SampledModel plate =
      test::sampled_solid(test::box_of({0.5, 0.4, 0.02}), 0.03F, 0.65F);
  RangeImage image =
      test::render({Pose::Identity(), 200, 200, 79.5F, 59.5F, 160, 120}, {test::wall(3)});
  Random noise(99);  // noise would decide the unconstrained directions
  for (std::size_t pixel = 0; pixel < image.depth.size(); ++pixel) {
    image.depth[pixel] += noise.normal(0.002F);
    const Vector3f n(noise.normal(0.005F), noise.normal(0.005F), -1);
    image.normals.set(pixel, n.normalized());
  }
  BoxScene scene;
  for (std::uint64_t trial = 0; trial < 20; ++trial) {
    Random random(trial);
    const Pose start =
        test::placed({0.1F, 0, 3.02F + random.uniform(-0.03F, 0.03F)}, 0.05F * random.direction());
    const Refined refined = refine_pose({&image, 1}, plate.view(), start, scene.options);
    EXPECT_FALSE(refined.moved_too_far) << trial;
    const Pose pose = refined.T_scene_model;
    EXPECT_TRUE(pose.matrix().allFinite());
    EXPECT_NEAR((pose * Vector3f(0, 0, -0.02F)).z(), 3, 1e-3) << "the front is on the wall";
    EXPECT_LT(pose.linear().col(2).head<2>().norm(), 2e-3F) << "and parallel to it";
    const Vector3f slide = pose.translation() - start.translation();
    EXPECT_LT(slide.head<2>().norm(), 0.04F) << trial;
  }
}

TEST(RefinePose, AllocatesNothing) {
  const BoxScene scene;
  const RangeImage image = scene.see();
  Random random;
  const Pose start = scene.off(random, 4 * kDegree, 0.03F);
  EXPECT_EQ(test::allocations_in([&] { scene.refine(image, start); }), 0U);
}

}  // namespace
}  // namespace trivet::kernels

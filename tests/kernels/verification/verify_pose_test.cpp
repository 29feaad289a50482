#include "kernels/verification/verify_pose.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>

#include "support/allocations.hpp"
#include "support/analytic_scene.hpp"
#include "support/random.hpp"
#include "support/reference_evidence.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;
using test::left_half;
using test::PlacedSurface;
using test::wall;

constexpr float kTolerance = 0.03F;  // a pixel is 0.015 wide at depth 3
const std::array<std::uint8_t, 1> kBackground{1};

ImageGeometry camera(const Pose& T_camera_scene = Pose::Identity()) {
  return {T_camera_scene, 200, 200, 79.5F, 59.5F, 160, 120};
}

struct BallScene {
  test::SampledModel ball = test::sampled_sphere(3000, 0.5F);
  Pose truth = test::placed({0.1F, -0.05F, 3});
  PlacedSurface surface{test::moved(test::sphere(0.5), truth)};

  Evidence verify_surfaces(const std::vector<PlacedSurface>& surfaces, const Pose& pose,
                           bool background = false) const {
    const std::array images{test::render(camera(), surfaces)};
    return verify(images, pose, background);
  }
  Evidence verify(std::span<const RangeImage> images, const Pose& pose,
                  bool background = false) const {
    VerifyOptions options;
    options.tolerance = kTolerance;
    if (background) options.plane_is_background = kBackground;
    Evidence evidence = verify_pose(images, ball.view(), 3000, pose, options);
    ContourScratch scratch;
    evidence.add(
        judge_contour(images, ball.view(), ball.view().points.size(), pose, options, scratch));
    return evidence;
  }
};

Pose shifted(const Pose& pose, const Vector3f& by) {
  Pose out = pose;
  out.pretranslate(by);
  return out;
}

TEST(VerifyPose, ScoresTheTruePoseNearOne) {
  const BallScene scene;
  for (const auto& surfaces : {std::vector{scene.surface}, std::vector{scene.surface, wall(3.5, 1)},
                               std::vector{scene.surface, wall(6)}}) {
    const Evidence e = scene.verify_surfaces(surfaces, scene.truth, true);
    EXPECT_GT(e.visible, 800U);
    EXPECT_EQ(e.visible,
              e.consistent + e.oblique + e.violation + e.occluded + e.unknown + e.background);
    EXPECT_GT(e.support(), 0.93F);
    EXPECT_GT(e.visible_fraction(), 0.97F);
    EXPECT_LT(e.violation_fraction(), 0.01F);
    EXPECT_GT(e.contour(), 0.97F);
    EXPECT_LT(e.rmse(), 0.007F);  // half a pixel on a slope
    EXPECT_GT(e.score(), 0.85F);
  }
}

// Balls, boxes and walls around the model, parts of which are hidden, unmeasured or outside the
// image.
TEST(VerifyPose, AgreesWithANaiveReference) {
  const test::Solid solid = test::cut_box();
  const test::SampledModel model = test::sampled_solid(solid, 0.03F, 0.66F);
  std::array<int, 7> total{};
  for (std::uint64_t trial = 0; trial < 40; ++trial) {
    test::Random random(trial);
    const auto place = [&](float side, float z) {
      return test::placed({random.uniform(-side, side), random.uniform(-side, side), z},
                          2.0F * random.direction());
    };
    const Pose truth = place(0.8F, 3);
    std::vector<PlacedSurface> surfaces{{test::moved(test::boundary(solid), truth)}, wall(3.3, 1)};
    surfaces.push_back({test::moved(test::sphere(0.3), place(1, 2.4F))});
    surfaces.push_back({test::moved(test::boundary(solid), place(1, 3.1F))});
    const Pose T_camera_scene = random.motion();
    RangeImage image = test::render(camera(T_camera_scene), surfaces);
    for (float& depth : image.depth) {
      if (random.below(3) == 0) depth = 0;
    }
    const Pose nearly = truth * test::placed(0.04F * random.direction(), 0.1F * random.direction());
    const Pose T_scene_model = T_camera_scene.inverse() * nearly;
    VerifyOptions options;
    options.tolerance = kTolerance;
    options.plane_is_background = kBackground;
    const Evidence e = verify_pose({&image, 1}, model.view(), 1 << 20, T_scene_model, options);
    const auto naive = reference::evidence(image, model, T_scene_model, kTolerance);
    EXPECT_LT(naive.undecided, 20);
    const std::array found{e.consistent, e.oblique, e.violation, e.occluded,
                           e.unknown,    e.outside, e.background};
    for (std::size_t k = 0; k < found.size(); ++k) {
      EXPECT_NEAR(found[k], naive.counts[k], naive.undecided) << trial << " count " << k;
      total[k] += naive.counts[k];
    }
    EXPECT_NEAR(e.weight, naive.weight, naive.undecided + 0.05);
  }
  for (const int count : total) EXPECT_GT(count, 100) << "every case was met";
}

TEST(VerifyPose, ScoresAMovedPoseLowerTheFartherItMoved) {
  const BallScene scene;
  const std::vector surfaces{scene.surface, wall(3.5, 1)};
  for (const Vector3f& direction : {Vector3f(1, 0, 0), Vector3f(0, -1, 0), Vector3f(0, 0, 1),
                                    Vector3f(0, 0, -1), Vector3f(0.6F, 0, 0.8F)}) {
    float last = scene.verify_surfaces(surfaces, scene.truth, true).score();
    for (const float distance : {0.02F, 0.06F, 0.15F, 0.4F}) {
      const float score =
          scene.verify_surfaces(surfaces, shifted(scene.truth, distance * direction), true).score();
      EXPECT_LT(score, last) << distance << " along " << direction.transpose();
      last = score;
    }
    EXPECT_LT(last, 0.2F);
  }
}

TEST(VerifyPose, CountsWhatSomethingNearerHides) {
  const BallScene scene;
  const Evidence e = scene.verify_surfaces({scene.surface, left_half(2)}, scene.truth);
  EXPECT_EQ(e.violation, 0U);
  EXPECT_EQ(e.unknown, 0U);
  EXPECT_NEAR(e.occluded, 0.37 * e.visible, 0.06 * e.visible);  // the ball is 0.1 to the right
  EXPECT_GT(e.support(), 0.93F) << "what is hidden does not count against it";
  EXPECT_GT(e.contour(), 0.97F);
}

TEST(VerifyPose, CountsMeasurementsBehindTheModel) {
  const BallScene scene;
  for (const bool background : {false, true}) {
    const Evidence e = scene.verify_surfaces({wall(4, 1)}, scene.truth, background);
    EXPECT_EQ(e.violation, e.visible);
    EXPECT_EQ(e.score(), 0);
  }
}

TEST(VerifyPose, DoesNotJudgeMissingDepth) {
  const BallScene scene;
  std::array images{test::render(camera(), {scene.surface})};
  for (std::size_t pixel = 0; pixel < images[0].depth.size(); ++pixel) {
    if (pixel % 160 < 86) images[0].depth[pixel] = 0;  // half of the ball
  }
  const Evidence e = scene.verify(images, scene.truth);
  EXPECT_NEAR(e.unknown, 0.5 * e.visible, 0.05 * e.visible);
  EXPECT_EQ(e.violation + e.occluded, 0U);
  EXPECT_GT(e.support(), 0.93F);
  EXPECT_NEAR(e.visible_fraction(), 0.5, 0.05);
  const Evidence blind = scene.verify_surfaces({}, scene.truth);
  EXPECT_EQ(blind.unknown, blind.visible);
  EXPECT_EQ(blind.score(), 0);
}

TEST(VerifyPose, IsNeutralOutsideTheImage) {
  BallScene scene;
  scene.truth = test::placed({1.2F, 0, 3});  // its center is on the image's edge
  const PlacedSurface ball{test::moved(test::sphere(0.5), scene.truth)};
  const Evidence e = scene.verify_surfaces({ball}, scene.truth);
  EXPECT_NEAR(e.outside, e.visible, 0.15 * e.visible);
  EXPECT_GT(e.visible_fraction(), 0.97F);
  EXPECT_GT(e.score(), 0.85F);
  const Evidence behind = scene.verify_surfaces({ball}, test::placed({0, 0, -3}));
  EXPECT_EQ(behind.visible, 0U);
  EXPECT_EQ(behind.score(), 0);
}

// The first and the last pixel of a row are adjacent only in memory.
TEST(VerifyPose, DoesNotReadBeyondTheEdgeOfTheImage) {
  for (const float side : {-1.0F, 1.0F}) {
    std::array images{test::render(camera(), {wall(3)})};
    for (std::size_t pixel = 0; pixel < images[0].depth.size(); ++pixel) {
      const bool opposite = side < 0 ? pixel % 160 == 159 : pixel % 160 == 0;
      if (!opposite) images[0].depth[pixel] = 0;
    }
    test::SampledModel plate;
    for (int i = -50; i <= 50; ++i) plate.add({0, 0.01F * static_cast<float>(i), 0}, {0, 0, -1});
    VerifyOptions options;
    options.tolerance = kTolerance;
    const Pose at_edge = test::placed({side * 79.5F * 3 / 200, 0, 3});
    const Evidence e = verify_pose(images, plate.view(), 101, at_edge, options);
    EXPECT_EQ(e.visible, 101U);
    EXPECT_EQ(e.unknown, 101U) << side;
  }
}

TEST(VerifyPose, GetsNoSupportFromABackgroundPlane) {
  const test::Solid box = test::box_of({0.4, 0.3, 0.2});
  const test::SampledModel model = test::sampled_solid(box, 0.03F, 0.54F);
  const Pose flush = test::placed({0, 0, 3.2F});  // its front lies in the wall
  const std::array images{test::render(camera(), {wall(3, 1)})};
  VerifyOptions options;
  options.tolerance = kTolerance;
  const Evidence plain = verify_pose(images, model.view(), 1 << 20, flush, options);
  EXPECT_EQ(plain.consistent, plain.visible);
  options.plane_is_background = kBackground;
  const Evidence e = verify_pose(images, model.view(), 1 << 20, flush, options);
  EXPECT_EQ(e.background, e.visible);
  EXPECT_EQ(e.score(), 0);
}

TEST(VerifyPose, LetsNothingReachThroughABackgroundPlane) {
  const BallScene scene;
  const Pose sunk = shifted(scene.truth, {0, 0, 0.35F});
  const std::vector surfaces{wall(3.0, 1)};
  const Evidence in_front = scene.verify_surfaces(surfaces, sunk, false);
  EXPECT_EQ(in_front.violation, scene.verify_surfaces({wall(3.0)}, sunk).violation);
  EXPECT_GT(in_front.occluded, in_front.visible / 3);
  const Evidence through = scene.verify_surfaces(surfaces, sunk, true);
  EXPECT_EQ(through.occluded, 0U);
  EXPECT_EQ(through.violation, in_front.violation + in_front.occluded);
}

TEST(VerifyPose, LetsWhatBearsOnAPlaneReachThroughIt) {
  const BallScene scene;
  const Pose sunk = shifted(scene.truth, {0, 0, 0.35F});
  const std::array images{test::render(camera(), {wall(3.0, 1)})};
  VerifyOptions options;
  options.tolerance = kTolerance;
  options.plane_is_background = kBackground;
  const auto verify = [&] {
    return verify_pose(images, scene.ball.view(), 1 << 20, sunk, options);
  };
  const Evidence solid = verify();
  options.bearing_plane = 1;
  const Evidence let_in = verify();
  EXPECT_GT(let_in.occluded, 0U);
  EXPECT_EQ(let_in.violation + let_in.occluded, solid.violation);
  EXPECT_EQ(let_in.background, solid.background) << "the plane supports it as little as before";
  options.bearing_plane = 0;
  options.open_planes.set(1);
  const Evidence under_it = verify();
  EXPECT_EQ(under_it.violation, let_in.violation);
  EXPECT_EQ(under_it.occluded, let_in.occluded);
  EXPECT_EQ(under_it.background, let_in.background);
}

TEST(VerifyPose, WantsNormalsToAgreeWhereThereAreAny) {
  const BallScene scene;
  std::array images{test::render(camera(), {scene.surface})};
  const Evidence good = scene.verify(images, scene.truth);
  for (std::size_t pixel = 0; pixel < images[0].depth.size(); ++pixel) {
    images[0].normals.set(pixel, {0, 0, 1});  // away from the sensor
  }
  const Evidence turned = scene.verify(images, scene.truth);
  EXPECT_EQ(turned.consistent, 0U);
  EXPECT_EQ(turned.oblique, good.consistent);
  for (std::size_t pixel = 0; pixel < images[0].depth.size(); ++pixel) {
    images[0].normals.set(pixel, Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  }
  const Evidence unknown = scene.verify(images, scene.truth);
  EXPECT_EQ(unknown.consistent, good.consistent);
  EXPECT_GT(unknown.support(), 0.7F);
  EXPECT_LT(unknown.support(), good.support());
}

TEST(VerifyPose, AddsUpOverImagesAndNamesTheExplainedPixels) {
  const BallScene scene;
  const Pose from_side = test::placed({0, 0, 3}, {0, 1.5707963F, 0}) * test::placed({0, 0, -3});
  const PlacedSurface side_view{test::moved(test::sphere(0.5), from_side * scene.truth)};
  const std::array images{test::render(camera(), {scene.surface}),
                          test::render(camera(from_side), {side_view}),
                          test::render(camera(), {scene.surface})};
  VerifyOptions options;
  options.tolerance = kTolerance;
  std::vector<std::uint32_t> explained;
  const auto verify_surfaces = [&](std::size_t first, std::size_t count,
                                   std::vector<std::uint32_t>* out) {
    return verify_pose(std::span(images).subspan(first, count), scene.ball.view(), 3000,
                       scene.truth, options, out);
  };
  const Evidence a = verify_surfaces(0, 1, nullptr), b = verify_surfaces(1, 1, nullptr),
                 all = verify_surfaces(0, 3, &explained);
  EXPECT_GT(b.consistent, 800U);
  EXPECT_EQ(all.visible, 2 * a.visible + b.visible);
  EXPECT_EQ(all.consistent, 2 * a.consistent + b.consistent);
  EXPECT_NEAR(all.weight, 2 * a.weight + b.weight, 1e-2);
  ASSERT_EQ(explained.size(), all.consistent);
  constexpr std::uint32_t kPixels = 160 * 120;
  std::size_t on_ball = 0;
  for (const std::uint32_t pixel : explained)
    on_ball += images[pixel / kPixels].depth[pixel % kPixels] > 0;
  EXPECT_GT(on_ball, explained.size() * 49 / 50);  // at the rim, a neighboring pixel is
  for (const std::uint32_t image : {0U, 1U, 2U}) {
    EXPECT_EQ(std::ranges::count(explained, image, [](auto pixel) { return pixel / kPixels; }),
              image == 1 ? b.consistent : a.consistent);
  }
}

TEST(VerifyPose, UsesTheFirstSamplesOnly) {
  const BallScene scene;
  const std::array images{test::render(camera(), {scene.surface})};
  VerifyOptions options;
  options.tolerance = kTolerance;
  const Evidence e = verify_pose(images, scene.ball.view(), 300, scene.truth, options);
  EXPECT_GT(e.visible, 80U);
  EXPECT_LT(e.visible, 150U);
  EXPECT_GT(e.support(), 0.92F) << "a prefix covers the model evenly";
}

TEST(VerifyPose, AllocatesNothing) {
  const BallScene scene;
  const std::array images{test::render(camera(), {scene.surface})};
  VerifyOptions options;
  options.tolerance = kTolerance;
  std::vector<std::uint32_t> explained;
  explained.reserve(3000);
  ContourScratch scratch;
  const auto run = [&] {
    Evidence e = verify_pose(images, scene.ball.view(), 3000, scene.truth, options, &explained);
    e.add(judge_contour(images, scene.ball.view(), scene.ball.view().points.size(), scene.truth,
                        options, scratch));
    explained.clear();
  };
  run();
  EXPECT_EQ(test::allocations_in(run), 0U);
}

}  // namespace
}  // namespace trivet::kernels

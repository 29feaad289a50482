#include "kernels/examine_pose.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "support/allocations.hpp"
#include "support/random.hpp"
#include "support/reference_examination.hpp"
#include "support/rendered_scene.hpp"
#include "support/shapes.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;

constexpr float kTolerance = 0.003F;
constexpr float kFar = 2;  // of a wall behind everything

/// Boxes seen by a small camera at the origin, each a model of its own.
struct Body {
  test::Shape shape;
  RayScene surface;
  ModelSamples samples;

  explicit Body(const Vector3f& half)
      : shape(test::box(-half, half)),
        surface(*RayScene::from_mesh(shape.vertices, shape.triangles)) {
    samples.points = shape.vertices;
    samples.diameter = 2 * half.norm();
    samples.spacing = 0;
  }
};

ImageGeometry camera() { return {Pose::Identity(), 150, 150, 79.5F, 59.5F, 160, 120}; }

/// What the camera measures of bodies in front of a wall.
RangeImage look(const std::vector<std::pair<const Body*, Pose>>& bodies, float wall = kFar) {
  RangeImage image;
  image.geometry = camera();
  const std::size_t n = std::size_t{image.geometry.width} * image.geometry.height;
  image.depth.assign(n, wall);
  image.plane.assign(n, 0);
  image.near_plane.assign(n, 0);
  image.normals.resize(n);
  for (std::size_t pixel = 0; pixel < n; ++pixel)
    image.normals.set(pixel, Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  for (std::size_t pixel = 0; pixel < n; ++pixel) {
    const Vector3f ray = image.geometry.back_project(pixel, 1);
    for (const auto& [body, pose] : bodies) {
      const Pose inverse = pose.inverse();
      const Hit hit = body->surface.intersect(inverse.translation(), inverse.linear() * ray, 0,
                                              std::numeric_limits<float>::infinity());
      if (hit && (image.depth[pixel] == 0 || hit.distance < image.depth[pixel]))
        image.depth[pixel] = hit.distance;
    }
  }
  return image;
}

Examination examine(const RangeImage& image, const Body& body, const Pose& pose,
                    const Symmetry& symmetry = {}, ExplainedPixels* explained = nullptr) {
  ExamineOptions options;
  options.verify.tolerance = kTolerance;
  static const std::array<std::uint8_t, 1> kBackground{1};
  options.verify.plane_is_background = kBackground;
  ExamineScratch scratch;
  Examination out;
  examine_pose({&image, 1}, body.surface, body.samples, symmetry, pose, options, scratch, out,
               explained);
  return out;
}

const Body& brick() {
  static const Body body({0.1F, 0.06F, 0.04F});
  return body;
}
const Pose kCorner = test::pose_of({0.6F, -0.5F, 0.3F}, {0.02F, -0.01F, 0.6F});

TEST(ExaminePose, FindsNothingAgainstTheTruth) {
  const Examination e = examine(look({{&brick(), kCorner}}), brick(), kCorner);
  EXPECT_GT(e.consistent, 800);
  EXPECT_EQ(e.consistent, e.covered);
  EXPECT_EQ(e.violation + e.occluded + e.unknown + e.background + e.outside, 0);
  EXPECT_LT(e.residual, 1e-6F);
  EXPECT_LT(e.smooth, 1e-6F);
  EXPECT_LT(e.slope, 1e-3F);
  EXPECT_GT(e.outline_free, 100);
  EXPECT_EQ(e.outline_crossed, 0);
  EXPECT_GT(e.hold, 0.005F) << "three faces hold a box";
}

// Boxes before and behind the model, with noise, holes and a labelled plane; crops of every stride.
TEST(ExaminePose, AgreesWithANaiveReference) {
  const Body small({0.03F, 0.02F, 0.015F});
  Examination total;
  for (std::uint64_t trial = 0; trial < 24; ++trial) {
    SCOPED_TRACE(trial);
    test::Random random(trial);
    const Body& body = trial % 3 == 0 ? small : brick();
    const auto between = [&](float low, float high) { return random.uniform(low, high); };
    const auto turn = [&] { return Vector3f(between(-2, 2), between(-2, 2), between(-2, 2)); };
    const Pose truth =
        test::pose_of(turn(), {between(-0.1F, 0.1F), between(-0.1F, 0.1F), between(0.4F, 0.9F)});
    const Pose other =
        test::pose_of(turn(), {between(-0.15F, 0.15F), between(-0.15F, 0.15F), between(0.3F, 1)});
    RangeImage image = look({{&body, truth}, {&brick(), other}}, between(0.7F, 1.2F));
    for (std::size_t pixel = 0; pixel < image.depth.size(); ++pixel) {
      image.depth[pixel] += random.normal(1e-3F);
      if (random.uniform(0, 1) < 0.05F) image.depth[pixel] = 0;
      image.plane[pixel] = image.near_plane[pixel] = pixel % 160 > 100 ? 1 : 0;
    }
    Pose pose = truth;
    pose.pretranslate(
        Vector3f(between(-4e-3F, 4e-3F), between(-4e-3F, 4e-3F), between(-4e-3F, 4e-3F)));
    ExplainedPixels explained;
    const Examination e = examine(image, body, pose, {}, &explained);
    const reference::Examination naive = reference::examination(
        image, body.surface, body.samples.diameter, pose, explained.square, kTolerance);
    const auto near = [&](float value, double expected, double relative) {
      EXPECT_NEAR(static_cast<double>(value), expected, relative * expected + 1e-6);
    };
    // Rounding decides at most a few rays.
    const double slack = 3.0 * explained.square * explained.square;
    EXPECT_NEAR(e.covered, naive.covered, slack);
    EXPECT_NEAR(e.outside, naive.outside, slack);
    EXPECT_NEAR(e.consistent, naive.consistent, slack);
    EXPECT_NEAR(e.violation, naive.violation, slack);
    EXPECT_NEAR(e.occluded, naive.occluded, slack);
    EXPECT_NEAR(e.unknown, naive.unknown, slack);
    EXPECT_NEAR(e.background, naive.background, slack);
    if (naive.consistent > 100 * explained.square * explained.square) {
      near(e.residual, naive.residual, 0.02);
      near(e.smooth, naive.smooth, 0.05);
      near(e.slope, naive.slope, 0.05);
      near(e.area, naive.area, 0.03);
      near(e.hold, naive.hold, 0.05);
    }
    EXPECT_EQ(explained.pixels.size() * explained.square * explained.square, e.consistent);
    total.consistent += e.consistent;
    total.violation += e.violation;
    total.occluded += e.occluded;
    total.unknown += e.unknown;
    total.background += e.background;
  }
  for (const float count : {total.consistent, total.violation, total.occluded, total.background})
    EXPECT_GT(count, 300) << "each is met";
}

TEST(ExaminePose, TellsAWrongTurnByTheSlopeOfWhatIsLeft) {
  const Pose flat = test::pose_of({0, 0, 0}, {0, 0, 0.6F});
  const RangeImage image = look({{&brick(), flat}});
  for (const float angle : {0.01F, 0.02F}) {  // at 0.1 m from the axis still within the tolerance
    const Examination e = examine(image, brick(), test::pose_of({0, angle, 0}, {0, 0, 0.6F}));
    EXPECT_NEAR(e.slope, angle, 0.15F * angle);
    EXPECT_GT(e.smooth, 0.9F * e.residual) << "no noise to average away";
  }
}

TEST(ExaminePose, AveragesNoiseAway) {
  const Pose flat = test::pose_of({0, 0, 0}, {0, 0, 0.6F});
  RangeImage image = look({{&brick(), flat}});
  test::Random random(7);
  for (float& depth : image.depth) depth += random.normal(1e-3F);
  const Examination e = examine(image, brick(), flat);
  EXPECT_NEAR(e.residual, 1.0F / 9, 0.02F) << "sigma is a third of the tolerance";
  EXPECT_LT(e.smooth, e.residual / 6) << "windows of 9 rays, fewer at the border";
}

TEST(ExaminePose, KnowsWhatHoldsAPose) {
  const Pose flat = test::pose_of({0, 0, 0}, {0, 0, 0.6F});
  const Examination face = examine(look({{&brick(), flat}}), brick(), flat);
  EXPECT_LT(face.hold, 1e-4F) << "one face slides";
  const Examination corner = examine(look({{&brick(), kCorner}}), brick(), kCorner);
  EXPECT_GT(corner.hold, 50 * face.hold + 1e-3F);

  // A rod's turn is not asked for where it is a symmetry.
  const test::Shape shape = test::prism(96, test::circle(0.03), -0.08, 0.08);
  Body rod({0.03F, 0.03F, 0.08F});
  rod.shape = shape;
  rod.surface = *RayScene::from_mesh(shape.vertices, shape.triangles);
  rod.samples.points = rod.shape.vertices;
  Symmetry symmetry;
  symmetry.axis = Symmetry::Axis{};
  const Pose tilted = test::pose_of({0.9F, 0.2F, 0}, {0.01F, 0.02F, 0.5F});
  const RangeImage image = look({{&rod, tilted}});
  const float asked = examine(image, rod, tilted).hold,
              open = examine(image, rod, tilted, symmetry).hold;
  EXPECT_LT(asked, 1e-3F);
  EXPECT_GT(open, 5 * asked);
}

TEST(ExaminePose, SeesWhereTheSceneRunsOn) {
  // The model is a part of a larger flat thing.
  const Body plate({0.3F, 0.3F, 0.04F});
  const Pose flat = test::pose_of({0, 0, 0}, {0, 0, 0.6F});
  const Examination e = examine(look({{&plate, flat}}), brick(), flat);
  EXPECT_EQ(e.consistent, e.covered);
  EXPECT_EQ(e.outline_free, 0);
  EXPECT_GT(e.outline_crossed, 100);
  RangeImage labelled = look({{&plate, flat}});
  labelled.plane.assign(labelled.plane.size(), 1);
  labelled.near_plane = labelled.plane;
  const Examination table = examine(labelled, brick(), flat);
  EXPECT_EQ(table.outline_crossed, 0) << "things stand on a table";
  EXPECT_EQ(table.consistent, 0) << "and are not made of it";
}

// The same depths, but the surface beyond the model's outline has another direction.
TEST(ExaminePose, TellsWhatTouchesFromWhatRunsOn) {
  const Body plate({0.3F, 0.3F, 0.04F});
  const Pose flat = test::pose_of({0, 0, 0}, {0, 0, 0.6F});
  RangeImage image = look({{&plate, flat}});
  const Eigen::Vector3f towards(0, 0, -1), aslant = Eigen::Vector3f(0, -1, -1).normalized();
  const auto paint = [&](const Eigen::Vector3f& beyond) {
    for (std::size_t pixel = 0; pixel < image.depth.size(); ++pixel) {
      const Eigen::Vector3f p = image.geometry.back_project(pixel, image.depth[pixel]);
      const bool on_brick = std::abs(p.x()) <= 0.1F && std::abs(p.y()) <= 0.06F;
      image.normals.set(pixel, on_brick ? towards : beyond);
    }
    return examine(image, brick(), flat);
  };
  const Examination on = paint(towards), touching = paint(aslant);
  EXPECT_EQ(on.outline_touching, 0);
  EXPECT_GT(on.outline_crossed, 100);
  EXPECT_EQ(touching.outline_crossed, 0);
  EXPECT_EQ(touching.outline_touching, on.outline_crossed);
}

TEST(ExaminePose, LeavesOutWhatIsBehindOrBeside) {
  const RangeImage image = look({{&brick(), kCorner}});
  for (const Vector3f& place : {Vector3f(0, 0, -1), Vector3f(3, 0, 0.6F)}) {
    const Examination e = examine(image, brick(), test::pose_of({0, 0, 0}, place));
    EXPECT_EQ(e.covered, 0);
    EXPECT_EQ(e.hold, 0);
  }
  const Examination cut = examine(image, brick(), test::pose_of({0, 0, 0}, {-0.32F, 0, 0.6F}));
  EXPECT_GT(cut.outside, 100);
  EXPECT_GT(cut.covered, 100);
}

TEST(ExaminePose, AllocatesNothingOnceItsMemoryIsThere) {
  const RangeImage image = look({{&brick(), kCorner}});
  ExamineOptions options;
  options.verify.tolerance = kTolerance;
  ExamineScratch scratch;
  Examination out;
  const auto run = [&] {
    examine_pose({&image, 1}, brick().surface, brick().samples, {}, kCorner, options, scratch, out);
  };
  run();
  EXPECT_EQ(test::allocations_in(run), 0U);
}

}  // namespace
}  // namespace trivet::kernels

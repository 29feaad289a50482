#include "kernels/verification/examine_pose.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "support/allocations.hpp"
#include "support/examine.hpp"
#include "support/random.hpp"
#include "support/reference_examination.hpp"
#include "support/rendered_bodies.hpp"
#include "support/smoothed_image.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;
using test::Body;
using test::brick;
using test::examine;
using test::examine_lowered;
using test::kFar;
using test::kTolerance;
using test::render;

const Pose kCorner = test::pose_of({0.6F, -0.5F, 0.3F}, {0.02F, -0.01F, 0.6F});

TEST(ExaminePose, FindsNothingAgainstTheTruth) {
  const Examination e = examine(render({{&brick(), kCorner}}), brick(), kCorner);
  EXPECT_GT(e.consistent, 800);
  EXPECT_EQ(e.consistent, e.covered);
  EXPECT_EQ(e.violation + e.occluded + e.unknown + e.background + e.outside, 0);
  EXPECT_LT(e.residual, 1e-6F);
  EXPECT_LT(e.smooth, 1e-6F);
  EXPECT_LT(e.slope, 1e-3F);
  EXPECT_GT(e.outline_free, 100);
  EXPECT_EQ(e.outline_crossed, 0);
  EXPECT_GT(e.stability, 0.005F) << "three faces hold a box";
}

/// Expects the sums over single rays to equal the examination.
void expect_sums(const std::vector<JudgedRay>& rays, const Examination& e, std::uint32_t square) {
  const auto count_of = [&](RayVerdict verdict) {
    return static_cast<float>(std::ranges::count(rays, verdict, &JudgedRay::verdict));
  };
  const auto side = static_cast<float>(square);
  EXPECT_EQ(side * side * count_of(RayVerdict::agrees), e.consistent);
  EXPECT_EQ(side * side * count_of(RayVerdict::background), e.background);
  EXPECT_EQ(side * side * count_of(RayVerdict::hidden), e.occluded);
  EXPECT_EQ(side * side * count_of(RayVerdict::unmeasured), e.unknown);
  EXPECT_GE(side * side * count_of(RayVerdict::looked_through) + 0.01F, e.violation);
  EXPECT_EQ(side * count_of(RayVerdict::runs_on), e.outline_crossed);
}

// Boxes in front of and behind the model, with noise, holes and a labeled plane; crops of every
// stride; scans with independent and with correlated errors of neighboring pixels.
TEST(ExaminePose, AgreesWithANaiveReference) {
  const Body small({0.03F, 0.02F, 0.015F});
  Examination total;
  double beside = 0;
  for (std::uint64_t trial = 0; trial < 48; ++trial) {
    SCOPED_TRACE(trial);
    test::Random random(trial);
    const Body& body = trial % 3 == 0 ? small : brick();
    const auto between = [&](float low, float high) { return random.uniform(low, high); };
    const auto turn = [&] { return Vector3f(between(-2, 2), between(-2, 2), between(-2, 2)); };
    const Pose truth =
        test::pose_of(turn(), {between(-0.1F, 0.1F), between(-0.1F, 0.1F), between(0.4F, 0.9F)});
    const Pose other =
        test::pose_of(turn(), {between(-0.15F, 0.15F), between(-0.15F, 0.15F), between(0.3F, 1)});
    RangeImage image = render({{&body, truth}, {&brick(), other}}, between(0.7F, 1.2F));
    for (std::size_t pixel = 0; pixel < image.depth.size(); ++pixel) {
      image.depth[pixel] += random.normal(1e-3F);
      if (random.uniform(0, 1) < 0.05F) image.depth[pixel] = 0;
      image.plane[pixel] = image.near_plane[pixel] = pixel % 160 > 100 ? 1 : 0;
    }
    Pose pose = truth;
    pose.pretranslate(
        Vector3f(between(-4e-3F, 4e-3F), between(-4e-3F, 4e-3F), between(-4e-3F, 4e-3F)));
    ExplainedPixels explained;
    ExamineOptions options;
    if (trial % 4 > 0) options.correlation = between(0, 1);
    if (trial % 4 > 1) options.edge_pixels = static_cast<int>(std::lround(between(2, 6)));
    std::vector<JudgedRay> rays;
    const Examination e = examine(image, body, pose, {}, &explained, options, &rays);
    expect_sums(rays, e, explained.square);
    for (const JudgedRay& ray : rays) {
      const Vector3f gap =
          (pose.inverse() * ray.place).cwiseAbs() - Vector3f(body.shape.vertices[0]).cwiseAbs();
      EXPECT_NEAR(gap.maxCoeff(), 0, 1e-5F);  // on a box
    }
    const reference::Examination naive = reference::examination(
        image, body.surface, body.samples.diameter, pose, explained.square, kTolerance,
        options.edge_pixels, static_cast<double>(options.correlation));
    beside += naive.beside;
    const auto near = [&](float value, double expected, double relative) {
      EXPECT_NEAR(static_cast<double>(value), expected, relative * expected + 1e-6);
    };
    // Rounding decides a few rays at most.
    const double slack = 3.0 * explained.square * explained.square;
    EXPECT_NEAR(e.covered, naive.covered, slack);
    EXPECT_NEAR(e.outside, naive.outside, slack);
    EXPECT_NEAR(e.consistent, naive.consistent, slack);
    EXPECT_NEAR(e.violation, naive.violation, slack);
    EXPECT_NEAR(e.occluded, naive.occluded, slack);
    EXPECT_NEAR(e.sunk, naive.sunk, slack);
    EXPECT_NEAR(e.unknown, naive.unknown, slack);
    EXPECT_NEAR(e.background, naive.background, slack);
    if (naive.consistent > 100 * explained.square * explained.square) {
      near(e.residual, naive.residual, 0.02);
      near(e.smooth, naive.smooth, 0.05);
      near(e.deviation, naive.deviation, 0.05);
      near(e.slope, naive.slope, 0.05);
      near(e.area, naive.area, 0.03);
      EXPECT_NEAR(static_cast<double>(e.relief), naive.relief, 0.02 * naive.relief + 0.01);
      near(e.stability, naive.stability, 0.05);
    }
    EXPECT_EQ(explained.pixels.size() * explained.square * explained.square, e.consistent);
    total.consistent += e.consistent;
    total.violation += e.violation;
    total.occluded += e.occluded;
    total.sunk += e.sunk;
    total.unknown += e.unknown;
    total.background += e.background;
  }
  for (const float count :
       {total.consistent, total.violation, total.occluded, total.sunk, total.background})
    EXPECT_GT(count, 200) << "each is met";
  EXPECT_GT(beside, 200);
}

// A face fits any plane; an edge, and even more a corner, fits only a similar shape.
TEST(ExaminePose, MeasuresHowFarFromAPlaneTheVisiblePartIs) {
  const Pose face = test::pose_of({0, 0, 0}, {0, 0, 0.6F});
  const Pose edge = test::pose_of({0.8F, 0, 0}, {0, 0, 0.6F});
  const auto relief = [](const Pose& pose) {
    return examine(render({{&brick(), pose}}), brick(), pose).relief;
  };
  EXPECT_LT(relief(face), 0.05F);
  EXPECT_GT(relief(edge), 2);
}

// A pixel attributed to an object may belong to a surface that the object would lie beneath.
// The wall is a background plane that hides the brick's far end.
TEST(ExaminePose, LetsOnlyWhatBearsOnAPlaneReachIntoIt) {
  const Body wall({0.4F, 0.4F, 0.01F});
  const Pose slanted = test::pose_of({0, 0.35F, 0}, {0, 0, 0.6F});
  const Pose straight = test::pose_of({0, 0, 0}, {0, 0, 0.63F});
  RangeImage image = render({{&brick(), straight}, {&wall, slanted}});
  const RangeImage only_wall = render({{&wall, slanted}});
  for (std::size_t pixel = 0; pixel < image.depth.size(); ++pixel)
    image.plane[pixel] = image.near_plane[pixel] =
        image.depth[pixel] == only_wall.depth[pixel] ? 1 : 0;
  ExamineOptions bears;
  bears.verify.bearing_plane = 1;
  const Examination solid = examine(image, brick(), straight);
  const Examination let_in = examine(image, brick(), straight, {}, nullptr, bears);
  EXPECT_GT(solid.violation, 100);
  EXPECT_EQ(solid.occluded, 0);
  EXPECT_EQ(let_in.violation, 0);
  EXPECT_GT(let_in.occluded, 100);
  EXPECT_EQ(let_in.overlaid, 0) << "the plane lies on nothing";
  EXPECT_EQ(let_in.sunk, 0);
  EXPECT_EQ(let_in.buried, 0);
  EXPECT_EQ(let_in.consistent, solid.consistent);
}

TEST(ExaminePose, TellsWhatLiesOnTheModelFromBlurredOutlines) {
  const Pose flat = test::pose_of({0, 0, 0}, {0, 0, 0.6F});
  const auto overlaid_by = [&](float half, int edge_pixels) {
    const Body cover({half, half, 0.01F});
    ExamineOptions options;
    options.edge_pixels = edge_pixels;
    const RangeImage image =
        render({{&brick(), flat}, {&cover, test::pose_of({0, 0, 0}, {0, 0, 0.5F})}});
    const Examination e = examine(image, brick(), flat, {}, nullptr, options);
    EXPECT_GE(e.occluded, e.overlaid);
    return e.overlaid;
  };
  // At a depth of 0.49, pixels are 3.3 mm wide: covers of 18 pixels and of two.
  const float sharp = overlaid_by(0.03F, 0), blurred = overlaid_by(0.03F, 2);
  EXPECT_GT(sharp, 100);
  EXPECT_LT(sharp, 18 * 18);
  EXPECT_GT(blurred, 0);
  EXPECT_LT(blurred, sharp);
  EXPECT_EQ(overlaid_by(0.03F, 8), 0) << "no wider than 2 x 9 pixels";
  EXPECT_EQ(overlaid_by(0.003F, 0), 0);
}

TEST(ExaminePose, DistinguishesSunkenFromHiddenParts) {
  const auto behind = [](float depth) {
    const Pose pose = test::pose_of({0, 0, 0}, {0, 0, 0.6F + depth});
    return examine(render({{&brick(), test::pose_of({0, 0, 0}, {0, 0, 0.6F})}}), brick(), pose);
  };
  const Examination sunk = behind(3 * kTolerance), hidden = behind(10 * kTolerance);
  EXPECT_GT(sunk.sunk, 0.9F * sunk.covered);
  EXPECT_GT(hidden.occluded, 0.9F * hidden.covered);
  EXPECT_EQ(hidden.sunk, 0);
}

TEST(ExaminePose, DetectsAWrongTurnByTheSlopeOfResiduals) {
  const Pose flat = test::pose_of({0, 0, 0}, {0, 0, 0.6F});
  const RangeImage image = render({{&brick(), flat}});
  for (const float angle : {0.01F, 0.02F}) {  // 0.1 m from the axis, still within the tolerance
    const Examination e = examine(image, brick(), test::pose_of({0, angle, 0}, {0, 0, 0.6F}));
    EXPECT_NEAR(e.slope, angle, 0.15F * angle);
    EXPECT_GT(e.smooth, 0.9F * e.residual) << "no noise to average away";
  }
}

TEST(ExaminePose, AveragesNoiseAway) {
  const Pose flat = test::pose_of({0, 0, 0}, {0, 0, 0.6F});
  RangeImage image = render({{&brick(), flat}});
  test::Random random(7);
  for (float& depth : image.depth) depth += random.normal(1e-3F);
  const Examination e = examine(image, brick(), flat);
  EXPECT_NEAR(e.residual, 1.0F / 9, 0.02F) << "sigma is a third of the tolerance";
  EXPECT_LT(e.smooth, e.residual / 6) << "windows of 9 rays, fewer at the border";
  EXPECT_LT(e.deviation, 0.15F * 1e-3F) << "also at the border";
}

// An object that is bent is off its model by what noise hides from single rays.
TEST(ExaminePose, MeasuresWhatAnObjectIsOffItsModelBelowTheNoise) {
  const Pose flat = test::pose_of({0, 0, 0}, {0, 0, 0.6F});
  RangeImage image = render({{&brick(), flat}});
  test::Random random(7);
  constexpr float kBend = 0.0005F;  // half the noise; its root mean square is 1 / sqrt(2) of it
  for (std::size_t pixel = 0; pixel < image.depth.size(); ++pixel) {
    image.depth[pixel] +=
        kBend * std::sin(0.2F * static_cast<float>(pixel % 160)) + random.normal(1e-3F);
  }
  const float squared = 0.5F * kBend * kBend;
  const Examination e = examine(image, brick(), flat);
  EXPECT_NEAR(e.deviation, std::sqrt(squared), 0.2F * std::sqrt(squared));
  ExamineOptions wavy;
  wavy.correlated_noise.height = std::sqrt(squared);
  EXPECT_LT(examine(image, brick(), flat, {}, nullptr, wavy).deviation, 0.6F * e.deviation)
      << "what the scan is known to err by is not the object's";
}

TEST(ExaminePose, KnowsWhatHoldsAPose) {
  const Pose flat = test::pose_of({0, 0, 0}, {0, 0, 0.6F});
  const Body plate({0.3F, 0.3F, 0.04F});
  const Examination face = examine(render({{&plate, flat}}), brick(), flat);
  EXPECT_LT(face.stability, 1e-4F) << "one face slides";
  const Examination corner = examine(render({{&brick(), kCorner}}), brick(), kCorner);
  EXPECT_GT(corner.stability, 50 * face.stability + 1e-3F);

  // A rod's rotation is not tested where it is a symmetry.
  const Body rod = test::rod_of(0.03F, 0.08F);
  const Symmetry::Axis axis{Vector3f::UnitX(), Vector3f::Zero()};
  const Pose tilted = test::pose_of({0.2F, 0.9F, 0}, {0.01F, 0.02F, 0.5F});
  const RangeImage image = render({{&rod, tilted}});
  const float asked = examine(image, rod, tilted).stability,
              open = examine(image, rod, tilted, axis).stability;
  EXPECT_LT(asked, 2e-3F);
  EXPECT_GT(open, 5 * asked);
}

// One face fixes neither two shifts nor a rotation; its outline does.
TEST(ExaminePose, HoldsAFaceByTheOutlineThatWasMeasured) {
  const Pose flat = test::pose_of({0, 0, 0}, {0, 0, 0.6F});
  const RangeImage image = render({{&brick(), flat}});
  EXPECT_GT(examine(image, brick(), flat).stability, 0.005F);

  RangeImage unmeasured = image;
  for (float& depth : unmeasured.depth)
    if (depth == kFar) depth = 0;
  const Examination alone = examine(unmeasured, brick(), flat);
  EXPECT_GT(alone.outline_free, 100);
  EXPECT_LT(alone.stability, 1e-4F) << "what was not measured shows no edge";

  const Body frame({0.3F, 0.3F, 0.01F});  // nearer, with the face in its window
  RangeImage framed = render({{&frame, test::pose_of({0, 0, 0}, {0, 0, 0.4F})}});
  for (std::size_t pixel = 0; pixel < image.depth.size(); ++pixel)
    if (image.depth[pixel] < kFar) framed.depth[pixel] = image.depth[pixel];
  EXPECT_LT(examine(framed, brick(), flat).stability, 1e-4F)
      << "nor does what something nearer cuts";

  const Pose nearer = test::pose_of({0, 0, 0}, {0, 0, 0.5F});
  EXPECT_EQ(examine(image, brick(), nearer).stability, 0) << "nor what does not agree within";
}

// The side of a rod does not fix its shift along the axis, whatever its orientation.
TEST(ExaminePose, HoldsARodByItsEndsWhereTheyAreVisible) {
  const Body rod = test::rod_of(0.02F, 0.1F), longer = test::rod_of(0.02F, 0.25F),
             screen({0.05F, 0.2F, 0.01F});
  const Symmetry::Axis axis{Vector3f::UnitX(), Vector3f::Zero()};
  for (const float angle : {0.0F, 0.2F, 0.4F, 0.7854F, 1.2F}) {
    SCOPED_TRACE(angle);
    const Pose pose = test::pose_of({0, 0, angle}, {0, 0, 0.5F});
    const auto along = [&](float x, float z) { return pose * test::pose_of({0, 0, 0}, {x, 0, z}); };
    const auto stability = [&](const RangeImage& image, const Pose& at) {
      return examine(image, rod, at, axis).stability;
    };
    const float open = stability(render({{&rod, pose}}), pose);
    const float hidden = stability(
        render({{&rod, pose}, {&screen, along(-0.1F, -0.1F)}, {&screen, along(0.1F, -0.1F)}}),
        pose);
    const float half_hidden =
        stability(render({{&rod, pose}, {&screen, along(0.1F, -0.1F)}}), pose);
    const float running_on = stability(render({{&longer, pose}}), pose);
    const float slid = stability(render({{&longer, along(-0.2F, 0)}}), pose);
    EXPECT_GT(open, 0.01F);
    EXPECT_LT(hidden, 0.05F * open);
    EXPECT_GT(half_hidden, 0.3F * open) << "one end is enough";
    EXPECT_LT(running_on, 0.05F * open);
    EXPECT_LT(slid, 0.05F * open) << "the end in the air is not the rod's";
  }
}

TEST(ExaminePose, HoldsAlikeInAnyUnitFrameAndResolution) {
  const Pose pose = test::pose_of({0.02F, 0.3F, 0.4F}, {0.02F, -0.01F, 0.6F});
  const RangeImage image = render({{&brick(), pose}});
  const float stability = examine(image, brick(), pose).stability;
  EXPECT_GT(stability, 0.001F);

  for (const float finer : {2.0F, 3.0F, 4.0F}) {
    ImageGeometry fine = test::camera();
    for (float* f : {&fine.fx, &fine.fy}) *f *= finer;
    for (float* c : {&fine.cx, &fine.cy}) *c = finer * (*c + 0.5F) - 0.5F;
    fine.width *= static_cast<std::uint32_t>(finer);
    fine.height *= static_cast<std::uint32_t>(finer);
    EXPECT_NEAR(examine(render({{&brick(), pose}}, kFar, fine), brick(), pose).stability, stability,
                0.2F * stability);
  }

  test::Random random;
  const Pose motion = random.motion();
  RangeImage moved = image;
  moved.geometry.T_camera_scene = motion.inverse();
  EXPECT_NEAR(examine(moved, brick(), motion * pose).stability, stability, 1e-2F * stability);

  const Body larger(Vector3f(100, 60, 40));
  RangeImage in_millimeters = image;
  for (float& depth : in_millimeters.depth) depth *= 1000;
  Pose far = pose;
  far.translation() *= 1000;
  ExamineOptions options;
  options.verify.tolerance = 1000 * kTolerance;
  ExamineScratch scratch;
  Examination out = examine_pose({&in_millimeters, 1}, {larger.surface, larger.samples, far}, {},
                                 options, scratch);
  EXPECT_NEAR(out.stability, stability, 1e-2F * stability);

  options.verify.tolerance = kTolerance;
  const std::array<RangeImage, 2> twice{image, image};
  out = examine_pose(twice, {brick().surface, brick().samples, pose}, {}, options, scratch);
  EXPECT_NEAR(out.stability, stability, 1e-4F * stability) << "means, over all images";
}

TEST(ExaminePose, LowersTheToleranceToWhatAPoseLeaves) {
  const Pose flat = test::pose_of({0, 0, 0}, {0, 0, 0.6F});
  RangeImage image = render({{&brick(), flat}});
  EXPECT_NEAR(examine_lowered(image, brick(), flat).tolerance, 0.1F * kTolerance, 1e-7F);
  EXPECT_EQ(examine(image, brick(), flat).tolerance, kTolerance) << "if it may not be lowered";
  test::Random random(7);
  constexpr float kNoise = 1e-4F;
  for (float& depth : image.depth) depth += random.normal(kNoise);
  const Examination right = examine_lowered(image, brick(), flat);
  EXPECT_GT(right.tolerance, 4 * kNoise);
  EXPECT_LT(right.tolerance, 8 * kNoise);
  EXPECT_GT(right.consistent, 0.99F * right.covered);
  const Pose off = test::pose_of({0, 0, 0}, {0, 0, 0.6F + 0.5F * kTolerance});
  EXPECT_EQ(examine_lowered(image, brick(), off).tolerance, kTolerance) << "residuals of 1.5 mm";
}

// Scan errors over many pixels, wherever they lie, are no evidence against a pose.
TEST(ExaminePose, SparesTheWavesOfTheScan) {
  const Pose flat = test::pose_of({0, 0, 0}, {0, 0, 0.6F});
  RangeImage image = render({{&brick(), flat}});
  constexpr float kHeight = 0.001F, kLength = 24;  // [pixel]
  for (std::size_t pixel = 0; pixel < image.depth.size(); ++pixel) {
    const auto u = static_cast<float>(pixel % 160), v = static_cast<float>(pixel / 160);
    const float turn = 2 * 3.14159265F / kLength;
    image.depth[pixel] += kHeight * std::sin(turn * u) * std::sin(turn * v);
  }
  const Examination unknown = examine(image, brick(), flat);
  ExamineOptions wavy;
  wavy.correlated_noise = {0.5F * kHeight, 0.1F};
  const Examination known = examine(image, brick(), flat, {}, nullptr, wavy);
  const float squares = 0.25F * kHeight * kHeight / (kTolerance * kTolerance);
  EXPECT_NEAR(unknown.residual, squares, 0.2F * squares);
  EXPECT_LT(known.residual, 0.2F * squares);
  EXPECT_EQ(known.mean_square, unknown.mean_square) << "is reported as measured";
  EXPECT_EQ(unknown.mean_square, unknown.residual);
  EXPECT_LT(known.smooth, 0.1F * unknown.smooth);
  EXPECT_LT(known.slope, 0.5F * unknown.slope);
  EXPECT_EQ(known.consistent, unknown.consistent);
}

ExamineOptions blurred(int edge_pixels, float correlation = 0) {
  ExamineOptions options;
  options.edge_pixels = edge_pixels;
  options.correlation = correlation;
  return options;
}

// Cameras that match windows show outlines displaced by up to half a window.
TEST(ExaminePose, ForgivesOutlinesThatAreShownBesideTheirPlace) {
  const Pose flat = test::pose_of({0, 0, 0}, {0, 0, 0.6F});
  const RangeImage image = render({{&brick(), flat}});
  RangeImage shifted = image;
  for (std::size_t pixel = 3; pixel < image.depth.size(); ++pixel)
    shifted.depth[pixel] = image.depth[pixel - 3];
  const Examination strict = examine(shifted, brick(), flat, {}, nullptr, blurred(0));
  EXPECT_GT(strict.violation, 50) << "the wall is seen through the side that it moved from";
  EXPECT_GT(strict.outline_crossed, 20) << "and it runs on over the other one";
  const Examination lenient = examine(shifted, brick(), flat, {}, nullptr, blurred(5));
  EXPECT_EQ(lenient.violation, 0);
  EXPECT_EQ(lenient.outline_crossed, 0);
  EXPECT_EQ(lenient.consistent, strict.consistent);
  EXPECT_GT(lenient.outline_free, strict.outline_free);
}

// The sensor saw through a corner of the brick: as wide as this, and as far behind it.
TEST(ExaminePose, TellsASolidPartThatIsSeenThroughFromErrors) {
  const Pose flat = test::pose_of({0, 0, 0}, {0, 0, 0.6F});
  const auto seen_through = [&](int width, float behind, int edge_pixels = 0) {
    RangeImage image = render({{&brick(), flat}});
    const float front = image.depth[60 * 160 + 80];
    for (int v = 52; v < 52 + width; ++v) {
      for (int u = 70; u < 70 + width; ++u)
        image.depth[static_cast<std::size_t>(v * 160 + u)] = front + behind;
    }
    return examine(image, brick(), flat, {}, nullptr, blurred(edge_pixels)).seen_through;
  };
  EXPECT_GE(seen_through(16, 10 * kTolerance), 100);
  EXPECT_EQ(seen_through(16, 4 * kTolerance), 0) << "not far behind";
  EXPECT_EQ(seen_through(2, 10 * kTolerance), 0) << "no wider than an outline's blur";
  EXPECT_EQ(seen_through(10, 10 * kTolerance, 5), 0) << "nor than that of a matching sensor";
  EXPECT_EQ(seen_through(0, 0), 0);
}

// Shiny surfaces have gaps: the same surface was measured on both sides of them.
TEST(ExaminePose, DistinguishesGapsFromEndsThatWereNotMeasured) {
  const Pose flat = test::pose_of({0, 0, 0}, {0, 0, 0.6F});
  const RangeImage whole = render({{&brick(), flat}});
  const auto without = [&](int first, int last, float beyond) {
    RangeImage image = whole;
    for (std::size_t pixel = 0; pixel < image.depth.size(); ++pixel) {
      const int u = static_cast<int>(pixel % 160);
      if (u >= first && u < last) image.depth[pixel] = 0;
      if (u >= last && beyond > 0) image.depth[pixel] += beyond;
    }
    return examine(image, brick(), flat);
  };
  const Examination middle = without(70, 90, 0), end = without(90, 160, 0);
  EXPECT_GT(middle.unknown, 500);
  EXPECT_EQ(middle.gaps, middle.unknown);
  EXPECT_GT(end.unknown, 500);
  EXPECT_EQ(end.gaps, 0);
  const Examination other = without(70, 90, 10 * kTolerance);
  EXPECT_EQ(other.unknown, middle.unknown);
  EXPECT_EQ(other.gaps, 0) << "the surface beyond is another";
}

TEST(ExaminePose, FindsAHoleInTheMiddleAtAnyBlur) {
  const Pose flat = test::pose_of({0, 0, 0}, {0, 0, 0.6F});
  RangeImage image = render({{&brick(), flat}});
  constexpr int kLeft = 68, kTop = 50, kAcross = 24, kDown = 20, kEdge = 5;
  for (int v = kTop; v < kTop + kDown; ++v) {
    for (int u = kLeft; u < kLeft + kAcross; ++u)
      image.depth[static_cast<std::size_t>(v * 160 + u)] = kFar;
  }
  const Examination strict = examine(image, brick(), flat, {}, nullptr, blurred(0));
  const Examination lenient = examine(image, brick(), flat, {}, nullptr, blurred(kEdge, 1));
  // A pixel next to another may be attributed to it, so one pixel is lost on each side. Rays are
  // two pixels apart.
  EXPECT_NEAR(strict.violation, (kAcross - 2) * (kDown - 2), 2 * (kAcross + kDown));
  constexpr int kWithin = (kAcross - 2 * kEdge) * (kDown - 2 * kEdge);
  EXPECT_NEAR(lenient.violation, kWithin, 2 * (kAcross + kDown - 4 * kEdge));
}

// A depth camera's filter flattens what it shows, a pocket of 15 mm by more than a tolerance.
TEST(ExaminePose, ExpectsWhatASmoothedScanShows) {
  test::Shape pocket = test::box({-0.1F, -0.07F, -0.02F}, {0.1F, 0.07F, 0.02F});
  pocket.join(test::box({-0.1F, -0.07F, -0.035F}, {-0.05F, 0.07F, -0.02F}));
  pocket.join(test::box({0.05F, -0.07F, -0.035F}, {0.1F, 0.07F, -0.02F}));
  const Body body(pocket, 0.25F);
  const Pose flat = test::pose_of({0, 0, 0.2F}, {0, 0, 0.6F});
  const RangeImage sharp = test::render({{&body, flat}}, 0.62F), smooth = test::smoothed(sharp, 4);
  ExamineOptions filtered;
  filtered.smoothing = 4;
  const auto share = [](const Examination& e) { return e.consistent / e.covered; };
  EXPECT_LT(share(examine(smooth, body, flat)), 0.75F);
  EXPECT_GT(share(examine(smooth, body, flat, {}, nullptr, filtered)), 0.97F);
  EXPECT_LT(share(examine(sharp, body, flat, {}, nullptr, filtered)), 0.75F)
      << "a sharp scan is not what the filter would show";
}

// The scene lies behind or in front of the model by this many tolerances.
TEST(ExaminePose, CountsAViolationMoreTheMoreItIsOne) {
  const Pose flat = test::pose_of({0, 0, 0}, {0, 0, 0.6F});
  const auto at = [&](float tolerances, float correlation) {
    const Pose moved = test::pose_of({0, 0, 0}, {0, 0, 0.6F + tolerances * kTolerance});
    return examine(render({{&brick(), moved}}), brick(), flat, {}, nullptr,
                   blurred(0, correlation));
  };
  const float whole = at(4, 0).violation;
  EXPECT_GT(whole, 1000);
  for (const float correlation : {0.4F, 1.0F}) {
    const float soft = 1.5F * correlation;
    EXPECT_EQ(at(0.99F, correlation).violation, 0);
    for (const float share : {0.1F, 0.5F, 0.9F}) {
      EXPECT_NEAR(at(1 + share * soft, correlation).violation, share * whole, 0.05F * whole);
      EXPECT_NEAR(at(1 + share * soft, 0).violation, whole, 0.05F * whole) << "else at once";
    }
    EXPECT_NEAR(at(1.01F + soft, correlation).violation, whole, 0.05F * whole);
    EXPECT_NEAR(at(-1 - 0.5F * soft, correlation).occluded, whole, 0.05F * whole)
        << "what hides the model hides it";
  }
}

TEST(ExaminePose, LeavesOutWhatIsBehindOrBeside) {
  const RangeImage image = render({{&brick(), kCorner}});
  for (const Vector3f& place : {Vector3f(0, 0, -1), Vector3f(3, 0, 0.6F)}) {
    const Examination e = examine(image, brick(), test::pose_of({0, 0, 0}, place));
    EXPECT_EQ(e.covered, 0);
    EXPECT_EQ(e.stability, 0);
  }
  const Examination cut = examine(image, brick(), test::pose_of({0, 0, 0}, {-0.32F, 0, 0.6F}));
  EXPECT_GT(cut.outside, 100);
  EXPECT_GT(cut.covered, 100);
}

TEST(ExaminePose, AllocatesNothingOnceItsMemoryIsThere) {
  const RangeImage image = render({{&brick(), kCorner}});
  ExamineOptions options;
  options.verify.tolerance = kTolerance;
  ExamineScratch scratch;
  const auto run = [&] {
    examine_pose({&image, 1}, {brick().surface, brick().samples, kCorner}, {}, options, scratch);
  };
  run();
  EXPECT_EQ(test::allocations_in(run), 0U);
}

}  // namespace
}  // namespace trivet::kernels

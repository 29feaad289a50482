#include "kernels/verification/edge_equations.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <vector>

#include "kernels/common/pose_math.hpp"
#include "kernels/verification/examine_pose.hpp"
#include "support/rendered_bodies.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;
using test::Body;
using test::brick;
using test::front_of_brick;
using test::kFar;
using test::render;

constexpr float kAgreement = 0.003F;  // tolerance of the examinations

/// The equations of an examination with measurements that err by a tenth of the tolerance.
PoseEquations equations_of(const RangeImage& image, const Body& body, const Pose& pose) {
  ExamineOptions options;
  options.verify.tolerance = kAgreement;
  options.error = 0.1F * kAgreement;
  ExamineScratch scratch;
  PoseEquations equations;
  examine_pose({&image, 1}, {body.surface, body.samples, pose}, {}, options, scratch,
               {.equations = &equations});
  return equations;
}

/// The pose after a few steps by these equations.
Pose solved(const RangeImage& image, const Body& body, Pose pose) {
  for (int step = 0; step < 4; ++step) {
    const PoseEquations e = equations_of(image, body, pose);
    const Eigen::Matrix<double, 6, 1> x = e.information.ldlt().solve(e.gradient);
    const double radius = 0.5 * static_cast<double>(body.samples.diameter);
    pose = small_motion((x.head<3>() / radius).cast<float>(), x.tail<3>().cast<float>(),
                        pose.translation()) *
           pose;
  }
  return pose;
}

/// The front of a brick, as a camera sees it that looks straight at it: 50 x 30 pixels.
const Pose kFacing = test::pose_of({0, 0, 0}, {0.01F, -0.02F, 0.64F});
constexpr float kPixel = 0.6F / 150;

TEST(PoseEquations, LeadAFlatFaceThatSlidBackToItsEnds) {
  const RangeImage image = render({{&brick(), kFacing}});
  for (const Vector3f& slide :
       {Vector3f(4, 0, 0), Vector3f(-3, 5, 0), Vector3f(0.6F, -0.4F, 0), Vector3f(0, 0, 0.4F)}) {
    const Pose start = Eigen::Translation3f(kPixel * slide) * kFacing;
    const Pose found = solved(image, brick(), start);
    EXPECT_LT((found.translation() - kFacing.translation()).norm(), 0.6F * kPixel)
        << slide.transpose();
    EXPECT_LT(rotation_angle(found.linear(), kFacing.linear()), 0.01F);
  }
  const Pose turned = test::pose_of({0, 0, 0.1F}, kFacing.translation());
  EXPECT_LT(rotation_angle(solved(image, brick(), turned).linear(), kFacing.linear()), 0.01F);
}

// Sensors lose pixels that see both sides of an edge, and what lies in the shadow beside it.
TEST(PoseEquations, LeadAFaceBackWhosePixelsAtItsEndsAreLost) {
  RangeImage image = render({{&brick(), kFacing}});
  const Column<float> seen = image.depth;
  for (int pixel = 4; pixel + 4 < static_cast<int>(seen.size()); ++pixel) {
    const auto depth_at = [&](int step) { return seen[static_cast<std::size_t>(pixel + step)]; };
    const bool before = depth_at(0) < kFar && (depth_at(1) == kFar || depth_at(-1) == kFar);
    const bool beyond = depth_at(0) == kFar && (depth_at(-4) < kFar || depth_at(4) < kFar);
    if (before || beyond) image.depth[static_cast<std::size_t>(pixel)] = 0;
  }
  const Pose start = Eigen::Translation3f(kPixel * Vector3f(0.9F, 0, 0)) * kFacing;
  const Pose found = solved(image, brick(), start);
  EXPECT_LT((found.translation() - kFacing.translation()).norm(), 0.3F * kPixel);
}

// A sensor has its shadow on one side: the face ends a pixel early there, and in place elsewhere.
TEST(PoseEquations, KeepAFaceInPlaceThatLosesPixelsOnOneSide) {
  const Pose straight = test::pose_of({0, 0, 0}, {0, 0, 0.64F});
  RangeImage image = render({{&brick(), straight}});
  const Column<float> seen = image.depth;
  for (std::size_t pixel = 3; pixel + 3 < seen.size(); ++pixel) {
    const bool is_first = seen[pixel] < kFar && seen[pixel - 1] == kFar;
    const bool is_in_shadow =
        seen[pixel] == kFar && (seen[pixel + 1] < kFar || seen[pixel + 3] < kFar);
    if (is_first || is_in_shadow) image.depth[pixel] = 0;
  }
  const Pose found = solved(image, brick(), straight);
  EXPECT_LT((found.translation() - straight.translation()).norm(), 0.5F * kPixel) << "not by one";
}

/// Fit normals to each pixel and the four beside it, over steps in depth, too.
void fit_normals(RangeImage& image) {
  const std::size_t width = image.geometry.width, height = image.geometry.height;
  const auto point_at = [&](std::size_t pixel) {
    return image.geometry.back_project(pixel, image.depth[pixel]);
  };
  for (std::size_t v = 1; v + 1 < height; ++v) {
    for (std::size_t u = 1; u + 1 < width; ++u) {
      const std::size_t at = v * width + u;
      const Vector3f right = point_at(at + 1) - point_at(at - 1),
                     down = point_at(at + width) - point_at(at - width);
      image.normals.set(at, down.cross(right).normalized());
    }
  }
}

// What a plate lies on is close behind it, so that normals are fitted to both; and where its side is
// seen, its outline lies on the table.
TEST(PoseEquations, LeadAPlateOnATableThatSlidBackToItsEnds) {
  const Body plate({0.1F, 0.06F, 0.01F}), table({0.4F, 0.4F, 0.01F});
  for (const float angle : {0.0F, 0.35F}) {
    const Pose right = test::pose_of({0, angle, 0.15F}, kFacing.translation());
    const Pose below = right * Eigen::Translation3f(0, 0, 0.02F);
    RangeImage image = render({{&plate, right}, {&table, below}});
    fit_normals(image);
    const Pose start = right * Eigen::Translation3f(-1.5F * kPixel, 0, 0);
    const Pose found = solved(image, plate, start);
    EXPECT_LT((found.translation() - right.translation()).norm(), 0.3F * kPixel) << angle;
    EXPECT_LT(rotation_angle(found.linear(), right.linear()), 0.01F) << angle;
  }
}

// Pixels that see both sides of a low step are measured, whatever lies in the shadow beside it.
TEST(PoseEquations, KeepAPlateInPlaceThatHasAShadowOnOneSide) {
  const Body plate({0.1F, 0.06F, 0.005F});
  RangeImage image = render({{&plate, kFacing}}, 0.65F);
  const Column<float> seen = image.depth;
  for (std::size_t pixel = 0; pixel + 1 < seen.size(); ++pixel) {
    if (seen[pixel] > seen[pixel + 1]) image.depth[pixel] = 0;
    // Only the side of the shadow holds it along x.
    if (pixel % image.geometry.width > 90) image.depth[pixel] = 0.635F;
  }
  const Pose found = solved(image, plate, kFacing);
  EXPECT_LT((found.translation() - kFacing.translation()).norm(), 0.05F * kPixel);
}

/// Information on a slide along x.
double information_on_slide(const RangeImage& image) {
  return equations_of(image, brick(), kFacing).information(3, 3);
}

TEST(PoseEquations, HoldASlideByEdgesAloneWhereTheSceneFallsBack) {
  RangeImage image = render({{&brick(), kFacing}});
  EXPECT_GT(information_on_slide(image), 1 / static_cast<double>(kPixel * kPixel));
  RangeImage unmeasured = image;
  for (float& depth : unmeasured.depth) depth = depth == kFar ? 0 : depth;
  EXPECT_LT(information_on_slide(unmeasured), 1) << "the face may go on there";
  RangeImage in_contact = image;
  for (float& depth : in_contact.depth) depth = depth == kFar ? 0.6F : depth;
  EXPECT_LT(information_on_slide(in_contact), 1) << "the face goes on";
}

TEST(PoseEquations, TakeNoEdgeForTheEndOfAnOpenSurface) {
  const RangeImage image = render({{&brick(), kFacing}});
  EXPECT_LT(equations_of(image, front_of_brick(), kFacing).information(3, 3), 1)
      << "what the front is a part of may be wider";
}

/// The image without the outermost pixels of what is nearer than the wall.
RangeImage without_rim(RangeImage image) {
  const std::vector<float> depth(image.depth.begin(), image.depth.end());
  const std::size_t width = image.geometry.width;
  for (std::size_t at = width; at + width < depth.size(); ++at) {
    for (const std::size_t beside : {at - 1, at + 1, at - width, at + width}) {
      if (depth[beside] == kFar) image.depth[at] = kFar;
    }
  }
  return image;
}

// Sensors drop the pixels that see both sides of an edge.
TEST(PoseEquations, KeepAFaceInPlaceWhoseRimIsNotMeasured) {
  const Pose turned =
      test::pose_of({0, 0, 0.15F}, kFacing.translation());  // unlike the pixels' grid
  RangeImage image = without_rim(render({{&brick(), turned}}));
  const auto off = [&] {
    return (solved(image, brick(), turned).translation() - turned.translation()).norm() / kPixel;
  };
  EXPECT_LT(off(), 0.1F) << "opposite edges agree on the shift";
  // Its right end touches something, and only the left one holds it along x.
  for (std::size_t at = 0; at < image.depth.size(); ++at) {
    if (at % image.geometry.width > 90) image.depth[at] = 0.6F;
  }
  EXPECT_LT(off(), 0.3F) << "those above and below tell the shift";
}

// They draw a face that slid far, but not where the right edge lies beside it.
TEST(PoseEquations, WeighFarEdgesLess) {
  const auto information = [](float slide) {
    const RangeImage image =
        render({{&brick(), Eigen::Translation3f(slide * kPixel, 0, 0) * kFacing}});
    return information_on_slide(image);
  };
  EXPECT_LT(information(9), 0.3 * information(0));
}

// In a window, shared errors do not average out.
TEST(PoseEquations, CountCorrelatedErrorsOncePerWindow) {
  const RangeImage image = render({{&brick(), kFacing}});
  ExamineOptions options;
  options.verify.tolerance = kAgreement;
  options.error = kAgreement;  // far above what half a pixel to the side makes of it
  options.window = 2;
  const auto depth_information = [&](float shared) {
    options.correlated_noise.height = shared;
    ExamineScratch scratch;
    PoseEquations e;
    examine_pose({&image, 1}, {brick().surface, brick().samples, kFacing}, {}, options, scratch,
                 {.equations = &e});
    return e.information(5, 5);
  };
  // Every second pixel has a ray, and a window 5 x 5 pixels.
  EXPECT_NEAR(depth_information(0) / depth_information(2 * kAgreement), 1 + 25.0 / 4 * 4, 1);
}

// What an oblique surface has within a pixel differs by more than depth errs.
TEST(PoseEquations, TrustObliqueSurfacesToHalfAPixel) {
  const auto held_along_normal = [](float angle) {
    const Pose pose = test::pose_of({angle, 0, 0}, kFacing.translation());
    const Eigen::Vector3f n = pose.linear().col(2);
    return n.cast<double>().dot(equations_of(render({{&brick(), pose}}), brick(), pose)
                                    .information.bottomRightCorner<3, 3>() *
                                n.cast<double>());
  };
  EXPECT_LT(held_along_normal(0.6F), 0.1 * held_along_normal(0)) << "of nearly as many pixels";
}

// The side of a sheet is as wide as the blur of its edge, all along which sensors err alike.
TEST(PoseEquations, TrustSidesOneRayWideLess) {
  const auto held_by_side = [](float half_thickness) {
    const Body plate({0.1F, 0.06F, half_thickness});
    const Pose pose = test::pose_of({0.6F, 0, 0}, kFacing.translation());
    RangeImage image = render({{&plate, pose}});
    for (float& depth : image.depth) depth = depth == kFar ? 0 : depth;  // no edges
    const Eigen::Vector3d across_side = pose.linear().col(1).cast<double>();
    return across_side.dot(equations_of(image, plate, pose).information.bottomRightCorner<3, 3>() *
                           across_side);
  };
  const double wide = held_by_side(0.04F);       // 11 pixels
  EXPECT_LT(held_by_side(0.0075F), 0.1 * wide);  // 2 pixels, a ray
  EXPECT_GT(held_by_side(0.02F), 0.4 * wide);    // 6 pixels
}

}  // namespace
}  // namespace trivet::kernels

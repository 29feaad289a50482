#include "kernels/verification/judge_outline.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "kernels/verification/examine_pose.hpp"
#include "support/examine.hpp"
#include "support/rendered_bodies.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;
using test::Body;
using test::brick;
using test::examine;
using test::examine_lowered;
using test::front_of_brick;
using test::kFar;
using test::render;

TEST(JudgeOutline, FindsWhereTheSceneRunsOn) {
  // The model is a part of a larger flat thing.
  const Body plate({0.3F, 0.3F, 0.04F});
  const Pose flat = test::pose_of({0, 0, 0}, {0, 0, 0.6F});
  const Examination e = examine(render({{&plate, flat}}), brick(), flat);
  EXPECT_EQ(e.consistent, e.covered);
  EXPECT_EQ(e.outline_free, 0);
  EXPECT_GT(e.outline_crossed, 100);
  RangeImage labeled = render({{&plate, flat}});
  labeled.plane.assign(labeled.plane.size(), 1);
  labeled.near_plane = labeled.plane;
  const Examination table = examine(labeled, brick(), flat);
  EXPECT_EQ(table.outline_crossed, 0) << "things stand on a table";
  EXPECT_EQ(table.consistent, 0) << "and are not made of it";
}

TEST(JudgeOutline, LetsTheSceneRunOnBeyondAnOpenSurface) {
  const Body plate({0.3F, 0.3F, 0.04F});
  const Pose flat = test::pose_of({0, 0, 0}, {0, 0, 0.6F});
  const Examination part = examine(render({{&plate, flat}}), front_of_brick(), flat);
  EXPECT_EQ(part.consistent, part.covered);
  EXPECT_EQ(part.outline, 0) << "nothing is known of what is beyond";
  const Examination alone = examine(render({{&brick(), flat}}), front_of_brick(), flat);
  EXPECT_GT(alone.outline, 100);
  EXPECT_EQ(alone.outline_free, alone.outline) << "it may as well end there";
}

// Surfaces that were made from points have a lip along their rim, behind them.
TEST(JudgeOutline, SeesThatASurfaceWithALipAlongItsRimIsOpen) {
  test::Shape front = front_of_brick().shape;
  for (const float side : {-1.0F, 1.0F}) {
    const float x = side * 0.1F, y = side * 0.06F, lip = side * 0.003F;
    front.add({x, -0.06F, -0.039F}, {x, 0.06F, -0.039F}, {x - lip, 0.06F, -0.039F},
              {x - lip, -0.06F, -0.039F});
    front.add({-0.1F, y, -0.039F}, {0.1F, y, -0.039F}, {0.1F, y - lip, -0.039F},
              {-0.1F, y - lip, -0.039F});
  }
  const Body rolled(std::move(front), brick().samples.diameter);
  const Body plate({0.3F, 0.3F, 0.04F});
  const Pose flat = test::pose_of({0, 0, 0}, {0, 0, 0.6F});
  const auto outline = [&](const Body& body, int edge_pixels) {
    ExamineOptions options;
    options.edge_pixels = edge_pixels;
    return examine(render({{&plate, flat}}), body, flat, {}, nullptr, options).outline;
  };
  EXPECT_GT(outline(rolled, 0), 60) << "outlines are sharp, and it is a sheet of 1 mm";
  EXPECT_LT(outline(rolled, 2), 20);
  EXPECT_GT(outline(brick(), 2), 100) << "a body is closed at any distance from its end";
}

/// The front of a brick on a table a little behind it, all with normals.
RangeImage face_on_table(const Pose& pose, float height) {
  RangeImage image = render({{&brick(), pose}}, pose.translation().z() - 0.04F + height);
  for (std::size_t pixel = 0; pixel < image.depth.size(); ++pixel)
    image.normals.set(pixel, Vector3f(0, 0, -1));
  return image;
}

TEST(JudgeOutline, SeesASheetEndOnATableAFewTolerancesBelow) {
  const Pose flat = test::pose_of({0, 0, 0}, {0, 0, 0.6F});
  const RangeImage image = face_on_table(flat, 0.003F);
  const Examination e = examine_lowered(image, brick(), flat);
  EXPECT_GT(e.outline_free, 0.95F * e.outline);
  EXPECT_EQ(e.outline_crossed, 0);
  EXPECT_GT(e.stability, 0.005F) << "its outline holds it";
  const Examination coarse = examine(image, brick(), flat);
  EXPECT_EQ(coarse.outline_free, 0) << "a step of one tolerance is none";

  // Where the measured surface goes on in its plane, there is no end.
  const Pose slid = test::pose_of({0, 0, 0}, {0.03F, 0.02F, 0.6F});
  const Examination beside = examine_lowered(image, brick(), slid);
  EXPECT_LT(beside.outline_free, 0.6F * beside.outline);
  EXPECT_GT(beside.outline_crossed, 0.3F * beside.outline);
}

// A cylinder that goes on beyond the model's end bends away from the plane that touches it there.
TEST(JudgeOutline, SeesNoStepInASurfaceThatIsCurved) {
  constexpr float kRod = 0.05F;
  const Body rod = test::rod_of(kRod, 0.06F), longer = test::rod_of(kRod, 0.2F);
  // Turned in the image, so that rows and columns cross the end at an angle.
  const Pose pose = test::pose_of({0, 0, 0.5F}, {0, 0, 0.5F});
  RangeImage image = render({{&longer, pose}});
  for (std::size_t pixel = 0; pixel < image.depth.size(); ++pixel) {
    if (!(image.depth[pixel] < kFar)) continue;
    const Vector3f p = pose.inverse() * image.geometry.back_project(pixel, image.depth[pixel]);
    image.normals.set(pixel, pose.linear() * Vector3f(0, p.y(), p.z()).normalized());
  }
  const Examination e = examine_lowered(image, rod, pose);
  EXPECT_GT(e.outline_crossed, 0.2F * e.outline) << "both ends";
}

/// A brick's face in a wall that rises from it towards the camera by `slope`. The slope builds up
/// over the first `rounded` meters, like a sensor's rounded crease. A negative slope falls away.
RangeImage face_in_wall(float slope, float rounded) {
  RangeImage image = render({});
  constexpr float kFace = 0.56F;
  for (std::size_t pixel = 0; pixel < image.depth.size(); ++pixel) {
    const Vector3f p = image.geometry.back_project(pixel, kFace);
    const Vector3f beyond(std::max(std::abs(p.x()) - 0.1F, 0.0F) * (p.x() > 0 ? 1.0F : -1.0F),
                          std::max(std::abs(p.y()) - 0.06F, 0.0F) * (p.y() > 0 ? 1.0F : -1.0F), 0);
    const float far = beyond.norm(), turned = std::min(far, rounded);
    const float steep = rounded > 0 ? slope * turned / rounded : far > 0 ? slope : 0;
    image.depth[pixel] = kFace - (0.5F * steep * turned + slope * (far - turned));
    const Vector3f outwards = far > 0 ? Vector3f(beyond / far) : Vector3f::Zero();
    image.normals.set(pixel, (Vector3f(0, 0, -1) - steep * outwards).normalized());
  }
  return image;
}

TEST(JudgeOutline, DistinguishesTouchingFromContinuingSurfaces) {
  const Pose flat = test::pose_of({0, 0, 0}, {0, 0, 0.6F});
  const auto examine_slope = [&](float slope, float rounded) {
    return examine(face_in_wall(slope, rounded), brick(), flat);
  };
  const Examination on = examine_slope(0, 0);
  EXPECT_EQ(on.outline_touching, 0);
  EXPECT_GT(on.outline_crossed, 100);
  const Examination touching = examine_slope(0.63F, 0);
  EXPECT_EQ(touching.outline_crossed, 0);
  EXPECT_GT(touching.outline_touching, 0.4F * on.outline_crossed)
      << "the rest lies before the brick";
  const Examination rounded = examine_slope(0.8F, 0.02F);
  EXPECT_GT(rounded.outline_touching, 0.9F * on.outline_crossed) << "over five pixels";
  const Examination edge = examine_slope(-0.63F, 0);
  EXPECT_EQ(edge.outline_touching, 0) << "a body's own edge bends away";
  EXPECT_GT(edge.outline_crossed, 0.4F * on.outline_crossed);
}

// The brick sticks out of a slanted wall that hides its other part.
TEST(JudgeOutline, FindsWhereTheModelDipsBeneathTheScene) {
  const Body wall({0.4F, 0.4F, 0.01F}), cover({0.1F, 0.03F, 0.01F});
  const Pose slanted = test::pose_of({0, 0.35F, 0}, {0, 0, 0.6F});
  const Pose straight = test::pose_of({0, 0, 0}, {0, 0, 0.63F});
  const auto with_normals = [](RangeImage image) {
    const auto at = [&](std::size_t pixel) {
      return image.geometry.back_project(pixel, image.depth[pixel]);
    };
    for (std::size_t pixel = 0; pixel + 160 < image.depth.size(); ++pixel) {
      const Vector3f n = (at(pixel + 160) - at(pixel)).cross(at(pixel + 1) - at(pixel));
      image.normals.set(pixel, n.normalized());
    }
    return image;
  };
  const auto buried_with = [&](const Body& body, const Pose& pose) {
    const Examination e =
        examine(with_normals(render({{&brick(), straight}, {&body, pose}})), brick(), straight);
    EXPECT_GT(e.consistent, 100);
    EXPECT_GT(e.occluded, 100);
    return e.buried;
  };
  const RangeImage only_wall = with_normals(render({{&wall, slanted}}));
  EXPECT_GT(examine(only_wall, brick(), straight).buried, 20);
  EXPECT_EQ(buried_with(cover, test::pose_of({0, 0, 0}, {0, 0.03F, 0.5F})), 0)
      << "what lies in front has an edge";
  EXPECT_EQ(buried_with(wall, slanted), 0) << "and what leans on it makes a fold";
}

// The wider box's face goes on beyond the brick's: farther where it is slanted, but by no step.
TEST(JudgeOutline, SeesThatASlantedFaceGoesOnBeyondTheModel) {
  const Body wide({0.3F, 0.2F, 0.04F});
  const Pose slanted = test::pose_of({0, 0.9F, 0}, {0, 0, 0.9F});
  const auto outline = [&](const Body& body, bool with_normals) {
    RangeImage image = render({{&body, slanted}});
    for (std::size_t pixel = 0; with_normals && pixel < image.depth.size(); ++pixel)
      image.normals.set(pixel, slanted.linear() * Vector3f(0, 0, -1));
    return examine(image, brick(), slanted);
  };
  const Examination alone = outline(brick(), true), part = outline(wide, true);
  EXPECT_EQ(alone.outline_crossed, 0);
  EXPECT_GT(alone.outline_free, 0.9F * alone.outline);
  EXPECT_GT(part.outline_crossed, 0.3F * part.outline);
  EXPECT_LT(part.outline_free, 0.5F * part.outline);
  EXPECT_LT(part.outline_free, outline(wide, false).outline_free) << "nothing is known of it";
}

// One half of the brick dips beneath the face of a wider box that its other half agrees with.
TEST(JudgeOutline, CountsEndsThatTheSameSurfaceGoesOnBefore) {
  const Body wide({0.3F, 0.2F, 0.04F}), cover({0.05F, 0.08F, 0.01F});
  const Pose face = test::pose_of({0, 0, 0}, {0, 0, 0.6F});
  const Pose dipping = test::pose_of({0, -0.12F, 0}, {0.02F, 0, 0.6F});
  using Bodies = std::vector<std::pair<const Body*, Pose>>;
  const auto outline = [&](const Bodies& bodies, bool with_normals) {
    RangeImage image = render(bodies);
    for (std::size_t pixel = 0; with_normals && pixel < image.depth.size(); ++pixel)
      image.normals.set(pixel, {0, 0, -1});
    const Examination e = examine(image, brick(), dipping);
    EXPECT_GT(e.consistent, 100);
    EXPECT_GT(e.occluded, 100);
    return e.outline;
  };
  const Bodies alone{{&wide, face}};
  EXPECT_GT(outline(alone, true), outline(alone, false) + 20);
  const Bodies covered{{&wide, face}, {&cover, test::pose_of({0, 0, 0}, {0.08F, 0, 0.5F})}};
  EXPECT_LT(outline(covered, true), outline(alone, true) - 20) << "something else hides the ends";
}

}  // namespace
}  // namespace trivet::kernels

#include "kernels/simulation/pile.hpp"

#include <gtest/gtest.h>

#include "support/clearance.hpp"
#include "support/random.hpp"
#include "support/shapes.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using test::Shape;

const Vector2d kOpen = Vector2d::Constant(std::numeric_limits<double>::infinity());

struct Landing {
  Vector3d shift;
  std::vector<Contact> contacts;
};

Landing land(const Pile& pile, const Shape& body, double reach = 0) {
  Pile::Scratch scratch;
  Landing out;
  out.shift = pile.land(body.vertices, body.triangles, reach, scratch, out.contacts);
  return out;
}

Pose at(float x, float y, float z, const Eigen::Vector3f& rotation = {0, 0, 0}) {
  Pose pose = Pose::Identity();
  if (rotation.norm() > 0) {
    pose.linear() = Eigen::AngleAxisf(rotation.norm(), rotation.normalized()).toRotationMatrix();
  }
  pose.translation() << x, y, z;
  return pose;
}

const Shape kCube = test::box({-0.5F, -0.5F, -0.5F}, {0.5F, 0.5F, 0.5F});

TEST(Pile, BringsTheLowestPointToTheGround) {
  const Pile pile(2, 0.1, kOpen);
  EXPECT_EQ(land(pile, kCube.moved(at(0, 0, 3))).shift, Vector3d(0, 0, -2.5));
  EXPECT_EQ(land(pile, kCube.moved(at(50, -3, -4))).shift, Vector3d(0, 0, 4.5)) << "off the grid";
}

TEST(Pile, LaysFacesEdgesAndCornersOnBodies) {
  Pile pile(4, 0.13, kOpen);
  pile.add(kCube.moved(at(0, 0, 0.5F)).vertices, kCube.triangles);
  EXPECT_NEAR(land(pile, kCube.moved(at(0.25F, 0.5F, 5))).shift.z(), 1.5 - 5, 1e-12) << "a face";
  EXPECT_NEAR(land(pile, kCube.moved(at(1.25F, 0, 5))).shift.z(), 0.5 - 5, 1e-12) << "beside it";
  // A cube balanced on the middle of one of its edges, sqrt(1/2) below its center.
  const float quarter = std::numbers::pi_v<float> / 4;
  EXPECT_NEAR(land(pile, kCube.moved(at(0, 0, 5, {quarter, 0, 0}))).shift.z(),
              1 + std::sqrt(0.5) - 5, 1e-6);
  // An upright cube's edge along y at x = 0.5 meets an edge along x at y = 0, with both bodies'
  // corners far away: the height of the tilted cube there is sqrt(1/2).
  Pile ridge(4, 0.13, kOpen);
  ridge.add(kCube.moved(at(0, 0, 1, {0, quarter, 0})).vertices, kCube.triangles);
  EXPECT_NEAR(land(ridge, kCube.moved(at(0, 0, 5, {quarter, 0, 0}))).shift.z(),
              1 + 2 * std::sqrt(0.5) - 5, 1e-6)
      << "edges that cross";
}

TEST(Pile, KeepsBodiesBetweenWalls) {
  const Pile pile(2, 0.1, {0.75, 1});
  EXPECT_EQ(land(pile, kCube.moved(at(1, -3, 0.5F))).shift, Vector3d(-0.75, 2.5, 0));
  const Landing inside = land(pile, kCube.moved(at(0.2F, 0, 0.5F)), 0.1);
  EXPECT_EQ(inside.shift, Vector3d(0, 0, 0));
  bool wall = false;
  for (const Contact& contact : inside.contacts) {
    if (contact.normal.x() == 0) continue;
    wall = true;
    EXPECT_EQ(contact.normal, Vector3d(-1, 0, 0));
    EXPECT_NEAR(contact.gap, 0.05, 1e-7);
  }
  EXPECT_TRUE(wall) << "within reach";
}

// All pairs of shapes, randomly rotated, over cells smaller and larger than a facet.
TEST(Pile, AgreesWithTheClearanceOfAllPairsOfTriangles) {
  const std::vector<Shape> shapes{kCube, test::ellipsoid({0.5F, 0.7F, 0.3F}, 9),
                                  test::prism(9, test::teeth(3, 0.2), -0.3, 0.3, 0.5),
                                  test::tetrahedron()};
  for (std::uint64_t round = 0; round < 60; ++round) {
    test::Random random(round);
    const auto place = [&](float z) {
      Pose pose = random.motion(0.6F);
      pose.translation().z() = z;
      return pose;
    };
    const Shape lower = shapes[round % 4].moved(place(2)),
                upper = shapes[round / 4 % 4].moved(place(9));
    Pile pile(3, round % 3 == 0 ? 0.02 : round % 3 == 1 ? 0.2 : 2, kOpen);
    pile.add(lower.vertices, lower.triangles);
    double expected = reference::clearance(reference::facets_of(upper.vertices, upper.triangles),
                                           reference::facets_of(lower.vertices, lower.triangles));
    for (std::size_t i = 0; i < upper.vertices.size(); ++i)
      expected = std::min(expected, static_cast<double>(upper.vertices[i].z()));
    const Landing found = land(pile, upper, 0.1);
    EXPECT_NEAR(found.shift.z(), -expected, 1e-7) << round;
    ASSERT_FALSE(found.contacts.empty());
    double least = 1;
    for (const Contact& contact : found.contacts) {
      least = std::min(least, contact.gap);
      EXPECT_NEAR(contact.normal.norm(), 1, 1e-12);
      EXPECT_GE(contact.normal.z(), 0);
      EXPECT_LE(contact.gap, 0.1);
    }
    EXPECT_NEAR(least, 0, 1e-12) << "it touches";
  }
}

TEST(Pile, IsTheSameForAnyOrderOfBodies) {
  const Shape a = kCube.moved(at(0, 0, 0.5F, {0.3F, 0.1F, 0})),
              b = kCube.moved(at(0.5F, 0.3F, 2, {1, 2, 3})), c = kCube.moved(at(0.2F, 0, 9));
  Pile first(3, 0.1, kOpen), second(3, 0.1, kOpen);
  first.add(a.vertices, a.triangles);
  first.add(b.vertices, b.triangles);
  second.add(b.vertices, b.triangles);
  second.add(a.vertices, a.triangles);
  EXPECT_EQ(land(first, c).shift, land(second, c).shift);
}

}  // namespace
}  // namespace trivet::kernels

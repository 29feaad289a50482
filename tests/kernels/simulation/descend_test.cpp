#include "kernels/simulation/descend.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <vector>

namespace trivet::kernels {
namespace {

using Eigen::Vector3d;

/// The four corners of a square of side 1 about `middle`, turned about y by `slope`.
std::vector<Contact> foot(const Vector3d& middle, double slope, double gap = 0) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(slope, Vector3d::UnitY()).toRotationMatrix();
  std::vector<Contact> contacts;
  for (const double x : {-0.5, 0.5}) {
    for (const double y : {-0.5, 0.5})
      contacts.push_back({middle + turn * Vector3d(x, y, 0), turn.col(2), gap});
  }
  return contacts;
}

TEST(Descend, FallsFreelyWithoutContacts) {
  const Motion motion = descend({}, {1, 2, 3}, 0.4, 0.01, 0.5);
  EXPECT_EQ(motion.shift, Vector3d(0, 0, -0.01));
  EXPECT_EQ(motion.turn, Vector3d(0, 0, 0));
}

TEST(Descend, RestsOnAFootUnderTheCenter) {
  const Motion motion = descend(foot({0, 0, 0}, 0), {0.2, -0.1, 0.5}, 0.4, 0.01, 0);
  EXPECT_LT(motion.shift.norm() + motion.turn.norm(), 1e-5);
}

TEST(Descend, ClosesAGapAndNoMore) {
  const Motion motion = descend(foot({0, 0, 0}, 0, 0.004), {0, 0, 0.5}, 0.4, 0.01, 0.5);
  EXPECT_NEAR(motion.shift.z(), -0.004, 1e-6);
  EXPECT_LT(motion.turn.norm(), 1e-5);
}

TEST(Descend, SlidesDownASlopeThatIsSteeperThanFriction) {
  const double slope = 0.5;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(slope, Vector3d::UnitY()).toRotationMatrix();
  const Vector3d center = 0.2 * turn.col(2);
  const auto move = [&](double friction) {
    return descend(foot({0, 0, 0}, slope), center, 0.4, 0.01, friction);
  };
  EXPECT_LT(move(std::tan(slope) + 0.05).shift.norm(), 1e-4) << "it sticks";
  // The acceleration along the slope is gravity less friction: fall (sin - friction cos).
  for (const double friction : {0.0, 0.2, 0.4}) {
    const Vector3d shift = move(friction).shift;
    EXPECT_NEAR(shift.dot(turn.col(0)), 0.01 * (std::sin(slope) - friction * std::cos(slope)),
                1e-5);
    EXPECT_NEAR(shift.dot(turn.col(2)), 0, 1e-5);
  }
}

TEST(Descend, TopplesOverItsFootTowardsTheCenter) {
  const Motion motion = descend(foot({0, 0, 0}, 0), {0.8, 0, 0.5}, 0.4, 0.01, 1);
  EXPECT_GT(motion.turn.y(), 0.001) << "about y, from z to x";
  EXPECT_LT(motion.shift.z(), 0);
  EXPECT_NEAR(motion.turn.x(), 0, 1e-5);
  for (const Contact& contact : foot({0, 0, 0}, 0)) {
    const Vector3d moved = motion.shift + motion.turn.cross(contact.point - Vector3d(0.8, 0, 0.5));
    EXPECT_GT(moved.z(), -1e-5) << "no contact is entered";
  }
}

}  // namespace
}  // namespace trivet::kernels

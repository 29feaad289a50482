#include "kernels/spin_images/rotation_code.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "support/random.hpp"

namespace trivet::kernels {
namespace {

Eigen::Matrix3f turn(float angle, const Eigen::Vector3f& axis) {
  return Eigen::AngleAxisf(angle, axis.normalized()).toRotationMatrix();
}

TEST(RotationCode, ReproducesTheRotation) {
  test::Random random;
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3f axis = random.direction();
    const Eigen::Matrix3f given = turn(random.uniform(0, std::numbers::pi_v<float>), axis);
    const Eigen::Matrix3f back = decode_rotation(encode_rotation(given));
    EXPECT_LT(Eigen::AngleAxisf(given.transpose() * back).angle(), 1e-3F)
        << "floats give angles of a matrix no better";
    EXPECT_LT((given - back).cwiseAbs().maxCoeff(), 1e-4F);
  }
}

TEST(RotationCode, HoldsWhatLiesAtTheBorders) {
  for (const Eigen::Vector3f& axis :
       {Eigen::Vector3f(1, 0, 0), Eigen::Vector3f(0, -1, 0), Eigen::Vector3f(0, 0, 1)}) {
    for (const float angle : {0.0F, std::numbers::pi_v<float> / 2, std::numbers::pi_v<float>}) {
      const Eigen::Matrix3f given = turn(angle, axis);
      EXPECT_LT((given - decode_rotation(encode_rotation(given))).cwiseAbs().maxCoeff(), 1e-4F);
    }
  }
  EXPECT_EQ(encode_rotation(Eigen::Matrix3f::Identity()),
            (RotationCode{65534, 32767, 32767, 32767}));
}

TEST(RotationCode, GivesARotationForAnyCode) {
  test::Random random;
  for (int i = 0; i < 100; ++i) {
    RotationCode code;
    for (std::uint16_t& number : code) number = static_cast<std::uint16_t>(random.below(65536));
    const Eigen::Matrix3f turn = decode_rotation(code);
    EXPECT_TRUE((turn * turn.transpose()).isIdentity(1e-5F));
    EXPECT_GT(turn.determinant(), 0);
  }
}

}  // namespace
}  // namespace trivet::kernels

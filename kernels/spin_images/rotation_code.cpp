#include "kernels/spin_images/rotation_code.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace trivet::kernels {
namespace {

constexpr float kScale = 32767;

std::uint16_t encode(float number) noexcept {
  return static_cast<std::uint16_t>(std::lround((number + 1) * kScale));
}

float decode(std::uint16_t code) noexcept { return static_cast<float>(code) / kScale - 1; }

}  // namespace

RotationCode encode_rotation(const Eigen::Matrix3f& turn) noexcept {
  Eigen::Quaternionf q(turn);
  q.normalize();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  return {encode(q.w()), encode(q.x()), encode(q.y()), encode(q.z())};
}

Eigen::Matrix3f decode_rotation(const RotationCode& code) noexcept {
  return Eigen::Quaternionf(decode(code[0]), decode(code[1]), decode(code[2]), decode(code[3]))
      .normalized()
      .toRotationMatrix();
}

}  // namespace trivet::kernels

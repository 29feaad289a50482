#include "engine/simulation/parts/shapes.hpp"

#include <array>
#include <numbers>

namespace trivet::engine::parts {
namespace {

Pose turn(float angle, const Vector3f& axis) {
  return Pose(Eigen::AngleAxisf(angle, axis).toRotationMatrix());
}

Symmetry declared(std::vector<Pose> poses) { return {std::move(poses), {}, true}; }

}  // namespace

float between(CounterRandom& random, float low, float high) {
  return static_cast<float>(random.uniform(static_cast<double>(low), static_cast<double>(high)));
}

std::uint32_t count_between(CounterRandom& random, std::uint32_t first, std::uint32_t last) {
  return first + static_cast<std::uint32_t>(random.next() % (last - first + 1));
}

Solid rod(float radius, float low, float high, float chamfer) {
  const float inner = radius - chamfer;
  if (!(chamfer > 0)) return cone(radius, low, radius, high);
  return kernels::turned(std::array<Eigen::Vector2f, 6>{{{0, low},
                                                         {inner, low},
                                                         {radius, low + chamfer},
                                                         {radius, high - chamfer},
                                                         {inner, high},
                                                         {0, high}}});
}

Solid cone(float r0, float z0, float r1, float z1) {
  return kernels::turned(std::array<Eigen::Vector2f, 4>{{{0, z0}, {r0, z0}, {r1, z1}, {0, z1}}});
}

Solid hexagon(float half_width) {
  return around_z(kernels::half_space(Vector3f::UnitX(), half_width), 6);
}

Solid block(const Vector3f& low, const Vector3f& high) {
  const Vector3f center = (low + high) / 2;
  return shifted(kernels::box(high - center), center.x(), center.y(), center.z());
}

Solid slab(float low, float high) {
  return kernels::half_space(Vector3f::UnitZ(), high) &
         kernels::half_space(-Vector3f::UnitZ(), -low);
}

Solid slot(float radius, float x0, float x1, float y) {
  return shifted(kernels::oblong(radius, radius, x1 - x0), x0, y, 0);
}

Solid shifted(const Solid& solid, float x, float y, float z) {
  Pose motion = Pose::Identity();
  motion.translation() = Vector3f(x, y, z);
  return moved(solid, motion);
}

Solid hole(float radius, float x, float y) { return shifted(rod(radius, -kFar, kFar), x, y, 0); }

Solid along_x(const Solid& solid) {
  return moved(solid, turn(std::numbers::pi_v<float> / 2, Vector3f::UnitY()));
}
Solid along_y(const Solid& solid) {
  return moved(solid, turn(-std::numbers::pi_v<float> / 2, Vector3f::UnitX()));
}

Symmetry no_symmetry() { return declared({}); }

Symmetry turns(std::uint32_t n) {
  std::vector<Pose> poses;
  for (std::uint32_t k = 1; k < n; ++k) {
    poses.push_back(
        turn(2 * std::numbers::pi_v<float> * static_cast<float>(k) / static_cast<float>(n),
             Vector3f::UnitZ()));
  }
  return declared(std::move(poses));
}

Symmetry turns_and_flips(std::uint32_t n) {
  Symmetry out = turns(n);
  const Pose flip = turn(std::numbers::pi_v<float>, Vector3f::UnitX());
  out.poses.push_back(flip);
  for (std::uint32_t k = 0; k + 1 < n; ++k) out.poses.push_back(out.poses[k] * flip);
  return out;
}

Symmetry any_turn(bool flip) {
  Symmetry out = flip ? half_turn_x() : no_symmetry();
  out.axis = Symmetry::Axis{};  // z through the origin
  return out;
}

Symmetry half_turn_x() { return declared({turn(std::numbers::pi_v<float>, Vector3f::UnitX())}); }

}  // namespace trivet::engine::parts

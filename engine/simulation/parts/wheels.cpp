#include <cmath>
#include <numbers>

#include "engine/simulation/parts/design.hpp"
#include "engine/simulation/parts/shapes.hpp"

namespace trivet::engine::parts {
namespace {

using kernels::half_space;

/// An infinite spur gear about z with tip radius 1; a tooth points along +x. The flanks are
/// straight at the usual pressure angle of 20 degrees.
Solid teeth(std::uint32_t count) {
  const float z = static_cast<float>(count), module = 2 / (z + 2), pitch = module * z / 2;
  const float slope = 20 * std::numbers::pi_v<float> / 180,
              half_tooth = std::numbers::pi_v<float> * module / 4;
  const float c = std::cos(slope), s = std::sin(slope);
  const Solid tooth = half_space({s, c, 0}, s * pitch + c * half_tooth);
  return rod(pitch - 1.25F * module, -kFar, kFar) | (around_z(tooth, count) & rod(1, -kFar, kFar));
}

}  // namespace

Design gear(CounterRandom& random) {
  const std::uint32_t count = count_between(random, 11, 22);
  const float height = between(random, 0.12F, 0.25F), hub = between(random, 0.32F, 0.45F);
  const Solid body = (teeth(count) & slab(-height, height)) |
                     rod(hub, 0, height + between(random, 0.2F, 0.4F), 0.04F);
  const Solid recess = rod(0.62F, -height - 1, -0.5F * height) - rod(hub, -kFar, kFar);
  return {body - rod(hub * between(random, 0.45F, 0.65F), -kFar, kFar) - recess, turns(count), 1};
}

Design keyed_gear(CounterRandom& random) {
  const std::uint32_t count = count_between(random, 11, 18);
  const float height = between(random, 0.14F, 0.25F), hub = between(random, 0.5F, 0.58F);
  const float bore = between(random, 0.24F, 0.3F), key = between(random, 0.1F, 0.13F);
  const float end = height + between(random, 0.1F, 0.25F);
  const Solid body = (teeth(count) & slab(-height, height)) | rod(hub, -end, end, 0.04F);
  const Solid keyway = block({0, -key, -kFar}, {bore + 0.15F, key, kFar});
  return {body - (rod(bore, -kFar, kFar) | keyway), half_turn_x(), 1};
}

Design ratchet(CounterRandom& random) {
  const std::uint32_t count = count_between(random, 7, 11);
  const float step = 2 * std::numbers::pi_v<float> / static_cast<float>(count),
              root = between(random, 0.74F, 0.8F);
  const float height = between(random, 0.12F, 0.25F), hub = between(random, 0.3F, 0.4F);
  // A tooth, steep at angle 0, from a blunt tip there down to the root's radius one step further.
  const Eigen::Vector2f tip(1.06F, 0), foot(root * std::cos(step), root * std::sin(step));
  const Eigen::Vector2f normal =
      Eigen::Vector2f(foot.y() - tip.y(), tip.x() - foot.x()).normalized();
  const Solid tooth =
      half_space(-Vector3f::UnitY(), 0) & half_space({-std::sin(step), std::cos(step), 0}, 0) &
      half_space({normal.x(), normal.y(), 0}, normal.dot(tip)) & rod(1, -height, height);
  Solid wheel =
      rod(root, -height, height) | rod(hub, 0, height + between(random, 0.15F, 0.4F), 0.04F);
  const Symmetry symmetry = turns(count);
  wheel = wheel | tooth;
  for (const Pose& turn : symmetry.poses) wheel = wheel | moved(tooth, turn);
  return {wheel - rod(hub * between(random, 0.45F, 0.65F), -kFar, kFar), symmetry, 1};
}

Design knob(CounterRandom& random) {
  const std::uint32_t count = count_between(random, 3, 6);
  const float height = between(random, 0.18F, 0.3F), place = between(random, 0.6F, 0.68F);
  const float lobe = place * std::sin(std::numbers::pi_v<float> / static_cast<float>(count)) *
                     between(random, 0.55F, 0.62F);
  const Solid lobes = around_z(shifted(rod(lobe, -1, 1), place, 0, 0), count);
  const Solid grip = blend(rod(0.55F, -1, 1), lobes, 0.15F) & slab(-height, height);
  const float stem = between(random, 0.28F, 0.36F), length = between(random, 0.25F, 0.5F);
  const Solid body = grip | rod(stem, -height - length, 0, 0.04F);
  return {body - rod(0.55F * stem, -kFar, -height - 0.1F), turns(count), 0};
}

}  // namespace trivet::engine::parts

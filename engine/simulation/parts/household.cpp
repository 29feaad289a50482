#include <cmath>

#include "engine/simulation/parts/design.hpp"
#include "engine/simulation/parts/shapes.hpp"

namespace trivet::engine::parts {
namespace {

/// A ring about z at a height.
Solid ring(float radius, float thickness, float z) {
  return shifted(kernels::torus(radius, thickness), 0, 0, z);
}

/// A bar along z with an oval section, longer along x.
Solid oval(float radius, float length, float low, float high) {
  const float x = length / 2 + radius;
  return slot(radius, -length / 2, length / 2, 0) & block({-x, -radius, low}, {x, radius, high});
}

}  // namespace

Design cup(CounterRandom& random) {
  const float bottom = between(random, 0.4F, 0.55F), top = bottom + between(random, 0.12F, 0.25F);
  const float rim = between(random, 0.6F, 0.8F), wall = 0.08F;
  const Solid outside = cone(bottom, -1, top, rim) | ring(top, 0.06F, rim);
  const Solid lid = cone(top + 0.04F, rim, top - between(random, 0.02F, 0.1F), 1) -
                    rod(top - between(random, 0.16F, 0.22F), 1 - between(random, 0.07F, 0.13F), 2);
  const Solid inside = cone(bottom - wall, wall - 1, top - wall, rim + 0.1F);
  return {outside | lid, any_turn(false), 0, outside - inside};
}

Design mug(CounterRandom& random) {
  const float radius = between(random, 0.55F, 0.75F), half = between(random, 0.65F, 0.85F);
  const float reach = between(random, 0.36F, 0.46F), grip = between(random, 0.08F, 0.11F);
  const Solid handle =
      shifted(along_y(kernels::torus(reach, grip)), radius, 0, between(random, -0.1F, 0.1F));
  const Solid inside = rod(radius - between(random, 0.07F, 0.1F), 0.1F - half, kFar);
  return {(rod(radius, -half, half, 0.03F) | handle) - inside, no_symmetry(), 1};
}

Design bottle(CounterRandom& random) {
  const float radius = between(random, 0.34F, 0.48F), neck = between(random, 0.14F, 0.2F);
  const float shoulder = between(random, 0, 0.35F), slope = between(random, 0.15F, 0.4F);
  const float throat = shoulder + slope, cap = throat + between(random, 0.08F, 0.25F);
  const Solid body = rod(radius, -1, shoulder + 0.01F, 0) & rod(radius, -1, kFar, 0.05F);
  return {
      body | cone(radius, shoulder, neck, throat) | rod(neck, throat - 0.05F, cap + 0.01F) |
          rod(neck + between(random, 0.03F, 0.08F), cap, cap + between(random, 0.12F, 0.2F), 0.02F),
      any_turn(false), 0};
}

Design flask(CounterRandom& random) {
  const float half = between(random, 0.2F, 0.3F), length = between(random, 0.3F, 0.5F);
  const float top = between(random, 0.3F, 0.6F), slope = between(random, 0.4F, 0.7F);
  const float neck = between(random, 0.13F, 0.18F), cap = between(random, 0.15F, 0.3F);
  // The shoulders slope down toward both ends of the oval.
  const float c = std::cos(slope), s = std::sin(slope);
  const Solid shoulders =
      kernels::half_space({s, 0, c}, c * top) & kernels::half_space({-s, 0, c}, c * top);
  const Solid body = oval(half, length, -1, top - 0.05F) & shoulders;
  return {
      body | rod(neck, 0, top + 0.1F) | rod(neck + 0.04F, top + 0.05F, top + 0.05F + cap, 0.02F),
      turns(2), 0};
}

Design can(CounterRandom& random) {
  const float radius = between(random, 0.5F, 0.8F), depth = between(random, 0.05F, 0.1F);
  const Solid lids =
      rod(radius - 0.07F, 0.9F - depth, kFar) | rod(radius - 0.07F, -kFar, depth - 0.9F);
  return {rod(radius, -0.9F, 0.9F, 0.02F) - lids, any_turn(true), 0};
}

Design drink_can(CounterRandom& random) {
  const float radius = between(random, 0.42F, 0.58F), top = radius - between(random, 0.08F, 0.12F);
  const float neck = between(random, 0.72F, 0.82F), foot = radius - between(random, 0.06F, 0.12F);
  const float bottom = between(random, -0.92F, -0.86F);
  const Solid body = cone(foot, -1, radius, bottom) | rod(radius, bottom - 0.01F, neck) |
                     cone(radius, neck, top, 0.95F) | rod(top, 0.9F, 1);
  const Solid opening = rod(top - 0.07F, 1 - between(random, 0.06F, 0.1F), kFar);
  return {body - opening, any_turn(false), 0};
}

Design carton(CounterRandom& random) {
  const float width = between(random, 0.5F, 0.8F), height = between(random, 0.15F, 0.4F);
  return {kernels::box({1, width, height}), turns_and_flips(2), 0};
}

Design bowl(CounterRandom& random) {
  const float foot = between(random, 0.35F, 0.5F), half = between(random, 0.3F, 0.45F);
  const float wall = between(random, 0.09F, 0.12F), grow = (1 - foot) / (2 * half);
  const Solid outside = cone(foot, -half, 1, half) | rod(foot - 0.05F, -half - 0.08F, 0);
  // Parallel to the outside, and extended beyond the rim.
  const Solid inside =
      cone(foot - wall + 0.09F * grow, 0.09F - half, 1 - wall + 0.5F * grow, half + 0.5F);
  return {outside - inside, any_turn(false), 0};
}

Design dish(CounterRandom& random) {
  const float flat = between(random, 0.5F, 0.65F), height = between(random, 0.2F, 0.3F);
  const Solid outside = cone(flat, -0.09F, 1, height) & rod(0.96F, -1, 1);
  const float grow = (1 - flat) / (height + 0.09F);
  const Solid inside = cone(flat - 0.02F, 0, flat - 0.02F + grow, 1);
  return {outside - inside, any_turn(false), 0};
}

Design marker(CounterRandom& random) {
  const float radius = between(random, 0.08F, 0.13F), cap = between(random, 0.1F, 0.5F);
  const float lip = radius + between(random, 0.02F, 0.04F);
  return {rod(radius, -1, cap + 0.1F, 0.02F) | rod(lip, cap, between(random, 0.85F, 1), 0.03F),
          any_turn(false), 0};
}

Design screwdriver(CounterRandom& random) {
  const std::uint32_t lobes = 2 * count_between(random, 2, 4);
  const float grip = between(random, 0.17F, 0.22F), shank = between(random, 0.06F, 0.08F);
  const float end = between(random, 0.6F, 1), knob = between(random, 0.06F, 0.09F);
  const Solid handle =
      (rod(grip, -1, 0) | around_z(shifted(rod(knob, -0.9F, -0.1F), grip, 0, 0), lobes)) |
      cone(grip, -0.01F, shank + 0.02F, 0.15F);
  const Solid tip = block({-0.12F, -0.04F, end - 0.02F}, {0.12F, 0.04F, end + 0.18F});
  return {handle | rod(shank, 0, end) | tip, turns(2), 0};
}

Design hammer(CounterRandom& random) {
  const float grip = between(random, 0.09F, 0.13F), head = between(random, 0.15F, 0.2F);
  const float face = between(random, 0.3F, 0.45F), peen = between(random, 0.45F, 0.65F);
  const Solid handle = oval(grip, 0.08F, -1, 0.75F);
  const Solid block_of_head = along_x(rod(head, -0.25F, face)) |
                              along_x(rod(head + 0.04F, face - 0.02F, face + 0.12F, 0.02F));
  const float slope = (head - 0.05F) / peen;
  const Vector3f up = Vector3f(-slope, 0, 1).normalized(), down(up.x(), 0, -up.z());
  const Solid wedge = block({-peen, -head, -head}, {0, head, head}) &
                      kernels::half_space(up, up.z() * head) &
                      kernels::half_space(down, up.z() * head);
  return {handle | shifted(block_of_head | wedge, 0, 0, 0.65F), no_symmetry(), 0};
}

Design tub(CounterRandom& random) {
  const float bottom = between(random, 0.55F, 0.7F), top = bottom + between(random, 0, 0.15F);
  const float half = between(random, 0.35F, 0.7F), wall = 0.08F;
  const Solid body = cone(bottom, -half, top, half);
  const Solid lid = rod(top + between(random, 0.03F, 0.06F), half - between(random, 0.1F, 0.2F),
                        half + between(random, 0.02F, 0.08F), 0.02F);
  const Solid inside =
      cone(bottom - wall, wall - half, top - wall, half) | rod(top - wall, half - 0.01F, kFar);
  return {body | lid, any_turn(false), 0, body - inside};
}

Design spray(CounterRandom& random) {
  const float radius = between(random, 0.32F, 0.42F), shoulder = between(random, -0.2F, 0.05F);
  const float head = between(random, 0.12F, 0.16F), nose = between(random, 0.45F, 0.6F);
  const Solid body = rod(radius, -1, shoulder, 0) | cone(radius, shoulder - 0.01F, 0.13F, 0.3F) |
                     rod(0.13F, 0.25F, 0.75F);
  const Solid top = block({-between(random, 0.2F, 0.4F), -head, 0.7F}, {nose, head, 0.98F});
  const float lever = between(random, 0.24F, 0.3F);
  const Solid trigger =
      block({lever, -0.06F, between(random, 0.38F, 0.48F)}, {lever + 0.1F, 0.06F, 0.75F});
  return {body | top | trigger, no_symmetry(), 0};
}

}  // namespace trivet::engine::parts

#include <algorithm>
#include <array>

#include "engine/simulation/parts/design.hpp"
#include "engine/simulation/parts/shapes.hpp"

namespace trivet::engine::parts {

Design hex_nut(CounterRandom& random) {
  const float half_width = 0.87F, height = between(random, 0.3F, 0.55F);
  const float bore = between(random, 0.42F, 0.58F), sink = 0.08F;
  const Solid body = hexagon(half_width) & rod(1.02F, -height, height, 0.14F);
  // Both countersinks taper toward the middle.
  const Solid top = cone(bore - sink, height - 2 * sink, bore + sink, height + 0.001F);
  const Solid bottom = cone(bore + sink, -height - 0.001F, bore - sink, -height + 2 * sink);
  return {body - (rod(bore, -kFar, kFar) | top | bottom), turns_and_flips(6), 1};
}

Design bolt(CounterRandom& random) {
  const float half_width = between(random, 0.34F, 0.42F), head = between(random, 0.26F, 0.36F);
  const float radius = half_width * between(random, 0.5F, 0.62F);
  const float length = between(random, 1.0F, 1.7F), below = 0.3F;
  // The lower chamfer of this rod is below the head.
  const Solid top = hexagon(half_width) &
                    rod(1.17F * half_width, -below, head, 0.16F * half_width) & slab(0, head);
  return {top | rod(radius, -length, 0.5F * head, 0.25F * radius), turns(6), 0};
}

Design cap_screw(CounterRandom& random) {
  const float head = between(random, 0.36F, 0.44F), height = between(random, 0.35F, 0.5F);
  const float radius = head * between(random, 0.52F, 0.62F), length = between(random, 0.9F, 1.6F);
  const Solid socket = hexagon(0.5F * head) & slab(0.45F * height, kFar);
  const Solid body =
      rod(head, 0, height, 0.05F) | rod(radius, -length, 0.5F * height, 0.25F * radius);
  return {body - socket, turns(6), 0};
}

Design pin(CounterRandom& random) {
  const float radius = between(random, 0.12F, 0.25F), groove = between(random, 0.4F, 0.7F);
  const Solid ring = rod(radius, groove, groove + 0.12F) - rod(0.75F * radius, -kFar, kFar);
  return {rod(radius, -1, 1, 0.05F) - ring, any_turn(false), 0};
}

Design washer(CounterRandom& random) {
  const float bore = between(random, 0.4F, 0.65F), height = between(random, 0.07F, 0.14F);
  return {rod(1, -height, height, 0.04F) - rod(bore, -kFar, kFar), any_turn(true), 1};
}

Design bushing(CounterRandom& random) {
  const float flange = between(random, 0.75F, 1.0F), radius = flange * between(random, 0.6F, 0.75F);
  const float bore = radius * between(random, 0.55F, 0.72F), length = between(random, 0.7F, 1.5F);
  const Solid body =
      rod(flange, 0, between(random, 0.14F, 0.22F), 0.03F) | rod(radius, 0.05F, length, 0.05F);
  return {body - rod(bore, -kFar, kFar), any_turn(false), 1};
}

}  // namespace trivet::engine::parts

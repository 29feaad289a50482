#include <array>
#include <cmath>

#include "engine/simulation/parts/design.hpp"
#include "engine/simulation/parts/shapes.hpp"

namespace trivet::engine::parts {
namespace {

/// The half space on the origin's side of a plane along y through (x, 0, 0) and (0, 0, z).
Solid below_slope(float x, float z) {
  const Vector3f normal = Vector3f(z, 0, x).normalized();
  return kernels::half_space(normal, normal.x() * x);
}

/// A rectangular plate with a hole in each corner, one of them displaced along x, and one hole in
/// between.
Solid plate_with_holes(CounterRandom& random, float least_move, float most_move) {
  const float half_width = between(random, 0.5F, 0.72F), height = between(random, 0.06F, 0.1F);
  const float radius = between(random, 0.09F, 0.13F), margin = between(random, 0.2F, 0.24F);
  const float x = 1 - margin, y = half_width - margin, corner = 0.08F;
  const float c = std::sqrt(0.5F);
  const Solid outline = kernels::box({1, half_width, height}) &
                        around_z(kernels::half_space({c, c, 0}, c * (1 + half_width - corner)), 2);
  const float center = between(random, 0.2F, 0.3F), move = between(random, least_move, most_move);
  const Solid holes = hole(radius, x - move, y) | hole(radius, x, -y) | hole(radius, -x, y) |
                      hole(radius, -x, -y) | hole(center, 0, 0);
  return outline - holes;
}

}  // namespace

Design bracket(CounterRandom& random) {
  const float length = between(random, 1.0F, 1.5F), top = between(random, 0.8F, 1.3F);
  const float width = between(random, 0.45F, 0.7F), wall = between(random, 0.12F, 0.18F);
  const Solid room = block({0, -width, 0}, {length, width, top});
  const Solid corner = blend(block({0, -width, 0}, {length, width, wall}),
                             block({0, -width, 0}, {wall, width, top}), 0.12F) &
                       room;
  const float reach = between(random, 0.5F, 0.7F);
  const Solid rib = room & block({0, -0.07F, 0}, {length, 0.07F, top}) &
                    below_slope(wall + reach * length, wall + reach * top);
  const float y = 0.52F * width;
  const float first = between(random, 0.09F, 0.13F), second = between(random, 0.09F, 0.13F);
  const float far = between(random, 0.66F, 0.8F), near = between(random, 0.45F, 0.6F);
  const Solid base_holes = hole(first, far * length, y) | hole(second, near * length, -y);
  // After along_x, the x axis points down.
  const float slot_end = between(random, 0.45F, 0.62F);
  const Solid slots = along_x(slot(0.09F, -0.78F * top, -slot_end * top, -y) |
                              hole(between(random, 0.09F, 0.13F), -0.68F * top, y));
  return {(corner | rib) - base_holes - slots, no_symmetry(), 4};
}

Design angle(CounterRandom& random) {
  const float x = between(random, 1.0F, 1.5F), y = between(random, 0.8F, 1.1F);
  const float z = between(random, 0.7F, 1.2F), wall = between(random, 0.12F, 0.18F);
  const float low = z * between(random, 0.5F, 0.7F), middle = (wall + y) / 2;
  const Solid floor = block({0, 0, 0}, {x, y, wall});
  const Solid back = block({0, 0, 0}, {wall, y, z});
  const Solid side = block({0, 0, 0}, {x * between(random, 0.6F, 0.8F), wall, low});
  const Solid floor_hole = hole(between(random, 0.12F, 0.2F), 0.7F * x, middle);
  const Solid back_slot =
      along_x(slot(between(random, 0.08F, 0.12F), -0.75F * z, -0.45F * z, middle)) &
      block({-1, -kFar, -kFar}, {0.3F, kFar, kFar});
  const Solid side_hole = shifted(along_y(rod(between(random, 0.08F, 0.11F), -1, 0.3F)), 0.42F * x,
                                  0, (wall + low) / 2);
  return {(floor | back | side) - (floor_hole | back_slot | side_hole), no_symmetry(), 3};
}

Design lever(CounterRandom& random) {
  const float length = between(random, 1.2F, 1.7F), thick = between(random, 0.08F, 0.13F);
  const float big = between(random, 0.38F, 0.5F), small = between(random, 0.2F, 0.28F);
  const float boss = big * between(random, 0.72F, 0.88F);
  const Solid arm = kernels::oblong(big, small, length) & slab(-thick, thick);
  const Solid hub = rod(boss, 0, thick + between(random, 0.2F, 0.4F), 0.04F);
  const Solid pin =
      shifted(rod(between(random, 0.1F, 0.13F), -thick - between(random, 0.15F, 0.3F), 0, 0.03F),
              0.4F * length, 0.08F, 0);
  const float bore = boss * between(random, 0.45F, 0.6F);
  const Solid cut =
      rod(bore, -kFar, kFar) | slot(0.09F, between(random, 0.66F, 0.74F) * length, length, 0);
  return {(arm | hub | pin) - cut, no_symmetry(), 2};
}

Design plate(CounterRandom& random) {
  return {plate_with_holes(random, 0, 0), turns_and_flips(2), 5};
}

Design drill_plate(CounterRandom& random) {
  return {plate_with_holes(random, 0.12F, 0.2F), no_symmetry(), 5};
}

}  // namespace trivet::engine::parts

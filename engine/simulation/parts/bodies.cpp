#include <cmath>

#include "engine/simulation/parts/design.hpp"
#include "engine/simulation/parts/shapes.hpp"

namespace trivet::engine::parts {

Design housing(CounterRandom& random) {
  const float width = between(random, 0.5F, 0.65F), base = between(random, 0.15F, 0.25F);
  const float roof = between(random, 0.6F, 0.85F), left = between(random, 0.5F, 0.62F);
  const float right = between(random, 0.3F, 0.45F);
  const float tower = between(random, 0.3F, 0.36F), at = between(random, -0.2F, 0);
  const float port = between(random, 0.2F, 0.25F), side = between(random, 0.1F, 0.2F);
  const float middle = (base + roof) / 2;
  const Solid body =
      blend(block({-left, -width + 0.1F, 0.02F}, {right, width - 0.06F, roof}),
            shifted(rod(tower, 0.3F, roof + between(random, 0.2F, 0.45F), 0.04F), at, 0, 0), 0.1F);
  const Solid outside =
      block({-1, -width, 0}, {1, width, base}) | body |
      shifted(along_x(rod(port, 0, between(random, 0.6F, 0.85F))), 0, side, middle);
  const float bore = tower * between(random, 0.5F, 0.65F), screw = between(random, 0.08F, 0.11F);
  const float x = 0.83F, y = width - 0.17F;
  const Solid holes = hole(bore, at, 0) | hole(screw, x, y) | hole(screw, x, -y) |
                      hole(screw, -x, y) |
                      shifted(along_x(rod(0.6F * port, 0.45F, kFar)), 0, side, middle);
  return {outside - holes, no_symmetry(), 4};
}

Design clamp(CounterRandom& random) {
  const float width = between(random, 0.22F, 0.34F), height = between(random, 0.7F, 0.95F);
  const float back = between(random, -0.4F, -0.2F), gap = height - between(random, 0.28F, 0.36F);
  const float screw = between(random, 0.35F, 0.5F), boss = between(random, 0.17F, 0.21F);
  const float c = std::sqrt(0.5F);
  const Solid frame = block({-0.75F, -width, -height}, {0.75F, width, height}) &
                      kernels::half_space({-c, 0, -c}, c * (0.55F + height)) &
                      kernels::half_space({-c, 0, c}, c * (0.6F + height));
  const Solid throat = block({back, -kFar, -gap}, {kFar, kFar, gap});
  const Solid lug = block({-0.65F, 0, -0.25F}, {-0.3F, width + between(random, 0.3F, 0.4F), 0.1F});
  const Solid anvil = shifted(rod(0.75F * boss, -gap - 0.1F, -gap + 0.12F, 0.02F), screw, 0, 0);
  const Solid body =
      ((frame | lug) - throat) | anvil |
      shifted(rod(boss, height - 0.1F, height + between(random, 0.15F, 0.3F), 0.03F), screw, 0, 0);
  const Solid holes = shifted(rod(0.55F * boss, 0, kFar), screw, 0, 0) |
                      shifted(along_x(rod(0.09F, -kFar, 0)), 0, width + 0.16F, -0.075F);
  return {body - holes, no_symmetry(), 2};
}

Design shaft(CounterRandom& random) {
  const float collar = between(random, 0.32F, 0.42F), seat = between(random, 0.24F, 0.29F);
  const float start = between(random, -0.55F, -0.3F), end = between(random, 0.35F, 0.6F);
  const float journal = between(random, 0.15F, 0.21F), tip = between(random, 0.13F, 0.19F);
  const Solid body = rod(journal, -1, start + 0.05F, 0.03F) |
                     rod(collar, start, start + between(random, 0.12F, 0.2F), 0.02F) |
                     rod(seat, start, end, 0.02F) | rod(tip, end - 0.05F, 1, 0.03F);
  const Solid keyway = block({seat - 0.11F, -0.08F, end - 0.45F}, {1, 0.08F, end - 0.08F});
  const float flat = between(random, 0.3F, 0.55F) * tip;
  const Solid cut = block({-1, flat, end + 0.12F}, {1, 1, 2});
  return {body - keyway - cut, no_symmetry(), 0};
}

Design yoke(CounterRandom& random) {
  const float half = between(random, 0.42F, 0.58F), width = between(random, 0.28F, 0.4F);
  const float arm = between(random, 0.13F, 0.18F), pin = between(random, 0.4F, 0.65F);
  const float stem = between(random, 0.2F, 0.26F), length = between(random, 0.5F, 1.1F);
  const Solid head = block({-half, -width, -0.4F}, {half, width, pin}) |
                     shifted(along_x(rod(width, -half, half)), 0, 0, pin);
  const Solid gap = block({arm - half, -kFar, -0.12F}, {half - arm, kFar, kFar});
  const Solid body = (head - gap) | rod(stem, -0.4F - length, -0.3F, 0.04F);
  const float radius = width * between(random, 0.4F, 0.55F);
  return {body - shifted(along_x(rod(radius, -kFar, kFar)), 0, 0, pin), turns(2), 2};
}

Design v_block(CounterRandom& random) {
  const float half = between(random, 0.55F, 0.7F), depth = between(random, 0.45F, 0.9F);
  const float height = between(random, 0.65F, 0.85F), apex = between(random, 0.32F, 0.4F);
  const float c = std::sqrt(0.5F), side = between(random, 0.28F, 0.4F);
  const Solid groove =
      kernels::half_space({c, 0, -c}, -c * apex) & kernels::half_space({-c, 0, -c}, -c * apex);
  const Solid relief = block({-0.07F, -kFar, apex - 0.1F}, {0.07F, kFar, kFar});
  const Solid foot = block({-0.25F, -kFar, -1}, {0.25F, kFar, 0.1F});
  const Solid rail =
      around_z(block({half - 0.12F, -kFar, side - 0.07F}, {kFar, kFar, side + 0.07F}), 2);
  return {block({-half, -depth, 0}, {half, depth, height}) - (groove | relief | foot | rail),
          turns(2), 0};
}

}  // namespace trivet::engine::parts

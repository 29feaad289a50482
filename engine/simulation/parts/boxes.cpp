#include "engine/simulation/parts/design.hpp"
#include "engine/simulation/parts/shapes.hpp"

namespace trivet::engine::parts {
namespace {

/// A block with one cut corner, and a hole that not all have.
Design cut_block(CounterRandom& random, bool drilled) {
  const float width = between(random, 0.5F, 0.8F), height = between(random, 0.25F, 0.4F);
  const float cut = between(random, 0.2F, 0.4F), bore = between(random, 0.1F, 0.16F);
  const float x = between(random, -0.5F, -0.2F), y = between(random, -0.2F, 0.2F) * width;
  const Solid body = block({-1, -width, -height}, {1, width, height}) -
                     block({1 - cut, width - 0.6F * cut, -kFar}, {kFar, kFar, kFar});
  if (!drilled) return {body, no_symmetry(), 0};
  return {body - hole(bore, x, y), no_symmetry(), 1};
}

}  // namespace

Design cut_block(CounterRandom& random) { return cut_block(random, false); }

Design drilled_block(CounterRandom& random) { return cut_block(random, true); }

Design tray(CounterRandom& random) {
  const float width = between(random, 0.5F, 0.85F), height = between(random, 0.4F, 0.8F);
  const float wall = between(random, 0.06F, 0.1F);
  const Solid box = block({-1, -width, 0}, {1, width, height});
  const Solid room = block({wall - 1, wall - width, wall}, {1 - wall, width - wall, kFar});
  const float notch = between(random, 0.2F, 0.4F);
  const Solid cut = block({1 - 2 * wall, -notch, 0.6F * height}, {kFar, 0.5F * notch, kFar});
  return {box - (room | cut), no_symmetry(), 0};
}

Design cover(CounterRandom& random) {
  const float width = between(random, 0.55F, 0.8F), height = between(random, 0.3F, 0.6F);
  const float boss = between(random, 0.12F, 0.2F), step = between(random, 0.25F, 0.5F);
  const Solid box = block({-1, -width, 0}, {1, width, height}) -
                    block({1 - step, -kFar, 0.6F * height}, {kFar, kFar, kFar});
  const Solid top = shifted(rod(boss, 0.5F * height, height + between(random, 0.08F, 0.2F)),
                            between(random, -0.6F, -0.2F), between(random, 0.1F, 0.4F) * width, 0);
  return {box | top, no_symmetry(), 0};
}

}  // namespace trivet::engine::parts

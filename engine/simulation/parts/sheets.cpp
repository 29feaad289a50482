#include <cmath>

#include "engine/simulation/parts/design.hpp"
#include "engine/simulation/parts/shapes.hpp"

namespace trivet::engine::parts {
namespace {

/// Half the thickness of sheet metal: 1.5 to 4 mm of parts of 6 to 16 cm.
float half_thickness(CounterRandom& random) { return between(random, 0.032F, 0.05F); }

/// What is cut off a corner of a rectangle of these half sides, at 45 degrees.
Solid corner_cut(float x, float y, float cut) {
  const float c = std::sqrt(0.5F);
  return ~kernels::half_space({c, c, 0}, c * (x + y - cut));
}

}  // namespace

Design sheet(CounterRandom& random) {
  const float thick = half_thickness(random), width = between(random, 0.45F, 0.75F);
  const Solid outline = block({-1, -width, -thick}, {1, width, thick}) -
                        corner_cut(1, width, between(random, 0.2F, 0.45F));
  const float notch = between(random, 0.25F, 0.5F), depth = between(random, 0.2F, 0.4F) * width;
  const Solid cut = block({-1.1F, -notch * width, -1}, {-1 + depth, notch * width * 0.4F, 1});
  const Solid holes =
      hole(between(random, 0.08F, 0.15F), between(random, -0.3F, 0.1F), -0.45F * width) |
      hole(between(random, 0.1F, 0.2F), between(random, 0.3F, 0.5F), 0.2F * width);
  return {outline - (cut | holes), no_symmetry(), 2};
}

Design sheet_angle(CounterRandom& random) {
  const float thick = 2 * half_thickness(random), width = between(random, 0.4F, 0.7F);
  const float length = between(random, 0.9F, 1.4F), height = between(random, 0.5F, 0.9F);
  const Solid legs =
      block({0, -width, 0}, {length, width, thick}) | block({0, -width, 0}, {thick, width, height});
  const float notch = between(random, 0.3F, 0.6F) * width;
  const Solid cut =
      block({between(random, 0.6F, 0.75F) * length, width - notch, -1}, {kFar, kFar, 0.3F}) |
      hole(between(random, 0.09F, 0.15F), 0.45F * length, -0.3F * width) |
      shifted(along_x(rod(between(random, 0.08F, 0.13F), -1, 1)), 0, 0.35F * width, 0.65F * height);
  return {legs - cut, no_symmetry(), 2};
}

Design sheet_channel(CounterRandom& random) {
  const float thick = 2 * half_thickness(random), width = between(random, 0.35F, 0.6F);
  const float low = between(random, 0.5F, 0.9F), top = between(random, 0.3F, 0.6F);
  const float height = between(random, 0.4F, 0.7F);
  const Solid folds = block({-low, -width, 0}, {thick, width, thick}) |
                      block({0, -width, 0}, {thick, width, height}) |
                      block({0, -width, height - thick}, {top, width, height});
  const Solid cut = hole(between(random, 0.08F, 0.13F), -0.6F * low, 0.4F * width) &
                    kernels::half_space({0, 0, 1}, 0.5F * height);
  const Solid corner = block({top - between(random, 0.15F, 0.25F), -kFar, height - 2 * thick},
                             {kFar, -0.4F * width, kFar});
  return {folds - (cut | corner), no_symmetry(), 1};
}

}  // namespace trivet::engine::parts

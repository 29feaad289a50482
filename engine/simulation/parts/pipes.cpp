#include <cmath>
#include <numbers>

#include "engine/simulation/parts/design.hpp"
#include "engine/simulation/parts/shapes.hpp"

namespace trivet::engine::parts {
namespace {

using kernels::half_space;

/// A quarter of a pipe bend in the plane y = 0 about the origin; the z axis halves it.
Solid quarter(float bend, float radius) {
  const float c = std::sqrt(0.5F);
  return along_y(kernels::torus(bend, radius)) & half_space({c, 0, -c}, 0) &
         half_space({-c, 0, -c}, 0);
}

/// Attach a solid to the end of the quarter at +x. Its z axis continues along the pipe, outward.
Solid at_end(const Solid& solid, float bend) {
  Pose end(
      Eigen::AngleAxisf(0.75F * std::numbers::pi_v<float>, Vector3f::UnitY()).toRotationMatrix());
  end.translation() = Vector3f(bend, 0, bend) * std::sqrt(0.5F);
  return moved(solid, end);
}

}  // namespace

Design flange(CounterRandom& random) {
  constexpr std::array<std::uint32_t, 5> kCounts{3, 4, 5, 6, 8};
  const std::uint32_t count = kCounts[count_between(random, 0, 4)];
  const float height = between(random, 0.07F, 0.13F), neck = between(random, 0.38F, 0.46F);
  const float top = height + between(random, 0.25F, 0.6F),
              bore = neck - between(random, 0.1F, 0.16F);
  const Solid body =
      rod(1, -height, height, 0.03F) | cone(0.57F, 0, neck, top) | rod(0.5F, -height - 0.07F, 0);
  const Solid hole = shifted(rod(between(random, 0.09F, 0.125F), -kFar, kFar), 0.78F, 0, 0);
  return {body - rod(bore, -kFar, kFar) - around_z(hole, count), turns(count), 1 + count};
}

Design elbow(CounterRandom& random) {
  const float bend = between(random, 0.6F, 0.85F), pipe = between(random, 0.26F, 0.36F);
  const float bore = pipe * between(random, 0.6F, 0.7F),
              collar = pipe * between(random, 1.3F, 1.6F);
  const float length = between(random, 0.14F, 0.3F);
  const Solid end = at_end(rod(collar, -0.1F, length, 0.03F), bend);
  const Solid end_bore = at_end(rod(bore, -0.01F, 1), bend);
  const Solid outside = quarter(bend, pipe) | around_z(end, 2);
  return {outside - (quarter(bend, bore) | around_z(end_bore, 2)), turns(2), 1};
}

Design street_elbow(CounterRandom& random) {
  const float bend = between(random, 0.55F, 0.75F), pipe = between(random, 0.28F, 0.36F);
  const float bore = pipe * between(random, 0.58F, 0.68F);
  const Solid socket = at_end(rod(pipe * between(random, 1.3F, 1.5F), -0.1F, 0.3F, 0.04F), bend);
  const Solid tail =
      mirrored_x(at_end(rod(1.1F * pipe, -0.05F, between(random, 0.35F, 0.8F), 0.03F), bend));
  const Solid end_bore = at_end(rod(bore, -0.01F, kFar), bend);
  const Solid plug = shifted(along_y(rod(between(random, 0.12F, 0.17F), 0, pipe + 0.18F, 0.03F)),
                             between(random, -0.1F, 0.1F), 0, bend);
  const Solid outside = quarter(bend, pipe) | socket | tail | plug;
  const Solid inside = quarter(bend, bore) | end_bore | mirrored_x(end_bore);
  return {outside - inside, no_symmetry(), 1};
}

Design tee(CounterRandom& random) {
  const float run = between(random, 0.8F, 1.05F), branch = between(random, 0.65F, 0.95F);
  const float pipe = between(random, 0.27F, 0.36F), bore = between(random, 0.58F, 0.7F);
  const float collar = between(random, 1.2F, 1.4F), length = between(random, 0.15F, 0.25F);
  const float narrow =
      pipe * between(random, 0.75F, 0.82F);  // the branch clears the sides of the run
  const Solid ends = around_z(along_x(rod(collar * pipe, run - length, run, 0.03F)), 2);
  const Solid outside =
      blend(along_x(rod(pipe, -run + 0.05F, run - 0.05F)), rod(narrow, 0, branch - 0.05F), 0.08F) |
      ends | rod(collar * narrow, branch - length, branch, 0.03F);
  const Solid inside = along_x(rod(bore * pipe, -kFar, kFar)) | rod(bore * narrow, 0, kFar);
  return {outside - inside, turns(2), 2};
}

}  // namespace trivet::engine::parts

/// The families of machine parts and of things of a household: each a short function of random
/// numbers.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "kernels/common/counter_random.hpp"
#include "kernels/simulation/solid.hpp"
#include "storage/data/model.hpp"

namespace trivet::engine::parts {

using kernels::CounterRandom;

/// A part before it has a size; about 2 units large, whatever is symmetric about the origin.
struct Design {
  kernels::Solid solid;
  Symmetry symmetry;              ///< exact by construction; declared
  std::uint32_t num_tunnels = 0;  ///< through holes that are independent: the genus of the surface
  /// The same thing open and empty, where the solid is closed; of the same symmetry.
  std::optional<kernels::Solid> hollow = std::nullopt;
};

struct Family {
  std::string_view name;
  Design (*draw)(CounterRandom&);
  std::uint64_t stream;         ///< of random numbers; equal for families that share dimensions
  float smallest_m, largest_m;  ///< diameters
  bool metal;
  bool mirrored;  ///< the mirror image of what is drawn: the other hand of the same stream
};

/// The families of machine parts, in the order in which make_parts takes them.
std::span<const Family> families();
/// Those of things of a household, which are made only where they are named.
std::span<const Family> household_families();

// Fasteners.
Design hex_nut(CounterRandom& random);
Design bolt(CounterRandom& random);
Design washer(CounterRandom& random);
Design bushing(CounterRandom& random);
// Wheels.
Design gear(CounterRandom& random);
Design keyed_gear(CounterRandom& random);
Design ratchet(CounterRandom& random);
Design knob(CounterRandom& random);
// Pipes.
Design flange(CounterRandom& random);
Design elbow(CounterRandom& random);
Design street_elbow(CounterRandom& random);
Design tee(CounterRandom& random);
// Plates.
Design bracket(CounterRandom& random);
Design angle(CounterRandom& random);
Design lever(CounterRandom& random);
Design plate(CounterRandom& random);
Design drill_plate(CounterRandom& random);  ///< a plate with one hole off its place
// Bodies.
Design housing(CounterRandom& random);
Design clamp(CounterRandom& random);
Design shaft(CounterRandom& random);
Design yoke(CounterRandom& random);
Design v_block(CounterRandom& random);
// Household.
Design cup(CounterRandom& random);  ///< a paper cup with a lid; hollow: without
Design mug(CounterRandom& random);
Design bottle(CounterRandom& random);
Design flask(CounterRandom& random);  ///< a bottle of oval section
Design can(CounterRandom& random);
Design drink_can(CounterRandom& random);
Design carton(CounterRandom& random);
Design bowl(CounterRandom& random);
Design dish(CounterRandom& random);
Design marker(CounterRandom& random);
Design screwdriver(CounterRandom& random);
Design hammer(CounterRandom& random);
Design tub(CounterRandom& random);  ///< with a lid; hollow: without
Design spray(CounterRandom& random);

}  // namespace trivet::engine::parts

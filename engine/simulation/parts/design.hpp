/// Families of machine parts and household objects, each a short function of random numbers.
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

/// A part before scaling, about 2 units large. Symmetric parts are symmetric about the origin.
struct Design {
  kernels::Solid solid;
  Symmetry symmetry;              ///< declared symmetry, exact by construction
  std::uint32_t num_tunnels = 0;  ///< number of independent through holes, the genus of the surface
  /// The object opened and emptied, if the solid is closed; it has the same symmetry.
  std::optional<kernels::Solid> hollow = std::nullopt;
};

struct Family {
  std::string_view name;
  Design (*draw)(CounterRandom&);
  std::uint64_t stream;  ///< stream of random numbers; equal for families that share dimensions
  float smallest_m, largest_m;  ///< range of diameters
  bool metal;
  bool mirrored;  ///< mirror image of the design drawn from the same stream
};

/// The families of machine parts, in the order of make_parts.
std::span<const Family> families();
/// Families that are made only on request.
std::span<const Family> other_families();

/// Families that are requested together, by the group's name.
struct Group {
  std::string_view name;
  std::span<const std::string_view> families;
};
std::span<const Group> groups();

// Fasteners.
Design hex_nut(CounterRandom& random);
Design bolt(CounterRandom& random);
Design cap_screw(CounterRandom& random);
Design pin(CounterRandom& random);
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
Design drill_plate(CounterRandom& random);  ///< a plate with one displaced hole
// Sheet metal, a fortieth to a twenty-fifth of the part's size thick.
Design sheet(CounterRandom& random);
Design sheet_angle(CounterRandom& random);
Design sheet_channel(CounterRandom& random);
// Boxes.
Design cut_block(CounterRandom& random);
Design drilled_block(CounterRandom& random);  ///< a cut block with one hole
Design tray(CounterRandom& random);
Design cover(CounterRandom& random);
// Bodies.
Design housing(CounterRandom& random);
Design clamp(CounterRandom& random);
Design shaft(CounterRandom& random);
Design yoke(CounterRandom& random);
Design v_block(CounterRandom& random);
// Household.
Design cup(CounterRandom& random);  ///< a paper cup with a lid; the hollow one has no lid
Design mug(CounterRandom& random);
Design bottle(CounterRandom& random);
Design flask(CounterRandom& random);  ///< a bottle with an oval section
Design can(CounterRandom& random);
Design drink_can(CounterRandom& random);
Design carton(CounterRandom& random);
Design bowl(CounterRandom& random);
Design dish(CounterRandom& random);
Design marker(CounterRandom& random);
Design screwdriver(CounterRandom& random);
Design hammer(CounterRandom& random);
Design tub(CounterRandom& random);  ///< a tub with a lid; the hollow one has no lid
Design spray(CounterRandom& random);

}  // namespace trivet::engine::parts

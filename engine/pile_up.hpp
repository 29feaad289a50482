/// Throw models on a heap.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "storage/model.hpp"

namespace trivet::engine {

/// A model somewhere in a world whose ground is the plane z = 0, z up.
struct PlacedModel {
  std::uint32_t model = 0;  ///< index
  Pose T_world_model = Pose::Identity();
};

/// Lay models down one after the other, each turned at random and touching what is below it.
///
/// models         at least one, with samples, diameter and centre
/// num_instances  every model comes once before one comes again
/// seed, stream   give the heap; another stream of one seed is another heap
/// Nothing enters anything (see kernels::HeightField), but balance is not asked for: of several
/// random placements the one whose centre lies lowest is taken, which flat sides and gaps between
/// others offer.
std::vector<PlacedModel> pile_up(std::span<const Model> models, std::size_t num_instances,
                                 std::uint64_t seed, std::uint64_t stream);

}  // namespace trivet::engine

/// Scene side of the voting: the pairs of each reference point as cells of the quantized feature.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernels/common/radix_sort.hpp"
#include "kernels/pair_features/ppf_table.hpp"
#include "storage/data/points.hpp"
#include "storage/data/ppf_table.hpp"

namespace trivet::kernels {

/// One look-up: every table entry of `cell` votes for the angle between itself and `rotation`.
struct SceneVote {
  std::uint32_t cell;
  std::uint16_t rotation;  ///< alpha_s, as a fraction of a full turn
};

/// Number of rotation bins for voting: 32 bins of 11.25 degrees, one cache line of counters per
/// point.
inline constexpr std::uint32_t kRotationBins = 32;
inline constexpr std::uint32_t kRotationShift = 11;  // 2^16 / 32 = 2^11

/// Rule for the cells in which a pair is looked up.
struct CellLookup {
  const PpfQuantization& quantization;
  /// s, 0 to 0.5: if a component lies in the outer share s of its bin, the adjacent bin is looked
  /// up too (1 to 16 cells, Vidal et al., Sensors 2018); 0 looks up one cell.
  float neighbor_share;
};

/// Working memory of collect_scene_votes.
struct VoteKeys {
  Column<std::uint64_t> bins;       ///< cell and rotation bin of each pair
  Column<std::uint32_t> rotations;  ///< of each pair
  RadixScratch sort;
};

/// Collect the look-ups of one reference point, sorted by cell so that the table is accessed in
/// ascending order.
///
/// neighbors  the second points of the pairs, with unit normals; may include the reference itself
/// Each (cell, rotation bin) is looked up at most once (Hinterstoisser et al., ECCV 2016, section
/// 3.4), so that large flat regions, which repeat the same pair, do not outvote the rest. The
/// lowest rotation represents its bin. votes is cleared; it keeps its capacity.
void collect_scene_votes(const ReferenceFrame& reference, const OrientedView& neighbors,
                         const CellLookup& lookup, PairScratch& scratch, VoteKeys& keys,
                         std::vector<SceneVote>& votes);

}  // namespace trivet::kernels

/// The scene side of the voting: for each reference point, its pairs as cells of the quantized
/// feature.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernels/pair_features/ppf_table.hpp"
#include "storage/data/points.hpp"
#include "storage/data/ppf_table.hpp"

namespace trivet::kernels {

/// One look-up: every table entry of `cell` votes for the angle between it and `rotation`.
struct SceneVote {
  std::uint32_t cell;
  std::uint16_t rotation;  ///< alpha_s, fraction of a full turn
};

/// How many bins the rotation is voted in: 32 bins of 11.25 degrees, one cache line of counters a
/// point.
inline constexpr std::uint32_t kRotationBins = 32;
inline constexpr std::uint32_t kRotationShift = 11;  // 2^16 / 32 = 2^11

/// Which cells a pair is looked up in.
struct CellLookup {
  const PpfQuantization& quantization;
  /// s, 0 to 0.5: where a component lies in the outer share s of its bin, the adjoining bin is
  /// looked up too (1 to 16 cells, Vidal et al., Sensors 2018); 0 looks up one cell.
  float neighbor_share;
};

/// Collect the look-ups of one reference point, sorted by cell so that the table is walked forward.
///
/// neighbors  the second points of the pairs, with unit normals; the reference itself may be among
///            them
/// Each (cell, rotation bin) is looked up at most once (Hinterstoisser et al., ECCV 2016,
/// section 3.4), so that large flat regions, which repeat the same pair, do not outvote the rest.
/// The lowest rotation stands for its bin. votes is cleared; it keeps its capacity.
void collect_scene_votes(const ReferenceFrame& reference, const OrientedView& neighbors,
                         const CellLookup& lookup, PairScratch& scratch,
                         std::vector<std::uint64_t>& keys, std::vector<SceneVote>& votes);

}  // namespace trivet::kernels

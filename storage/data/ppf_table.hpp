/// The point pair feature table of one model: a dense CSR over the quantized feature.
#pragma once

#include <cstdint>
#include <span>

namespace trivet {

/// One ordered pair of model points, stored by its reference point.
struct PpfEntry {
  std::uint16_t reference;  ///< index of the reference point in Model::ppf_points
  std::uint16_t angle;      ///< rotation angle alpha_m as a fraction of a full turn, 2^16 = 2 pi
  bool operator==(const PpfEntry&) const = default;
};
static_assert(sizeof(PpfEntry) == 4, "the table is stored as it is in memory");

/// Quantization of the pair feature (Drost et al., CVPR 2010, section 3.1).
struct PpfQuantization {
  float distance_step = 0;              ///< width of a distance bin [library unit], > 0
  std::uint32_t num_distance_bins = 0;  ///< number of bins; larger distances are not in the table
  std::uint32_t num_angle_bins = 0;     ///< bins over [0, pi] for each of the three angles

  std::uint32_t num_cells() const noexcept {
    return num_distance_bins * num_angle_bins * num_angle_bins * num_angle_bins;
  }
  bool operator==(const PpfQuantization&) const = default;
};

/// Entries of cell c are entries[offsets[c] .. offsets[c + 1]), sorted by reference, then angle.
struct PpfTableView {
  PpfQuantization quantization;
  /// Reference points are the points below this index. The others are near them or near their
  /// symmetric copies.
  std::uint32_t num_references = 0;
  std::span<const std::uint32_t> offsets;  ///< num_cells() + 1, non-decreasing
  std::span<const PpfEntry> entries;       ///< all entries, offsets.back() of them
};

}  // namespace trivet

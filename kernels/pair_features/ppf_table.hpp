/// Construction of a model's dense point pair table by counting sort.
///
/// Three steps, so that the engine may process chunks of references in parallel with the same
/// result: count each chunk's pairs per cell, turn the counts into write positions, fill.
#pragma once

#include <cstdint>
#include <span>

#include "kernels/pair_features/pair_feature.hpp"
#include "storage/common/columns.hpp"
#include "storage/data/model.hpp"
#include "storage/data/ppf_table.hpp"

namespace trivet::kernels {

/// Working columns for the pairs of one reference point.
struct PairScratch {
  explicit PairScratch(std::size_t num_points);
  PairFeaturesSpan features(std::size_t n) noexcept;

  Column<float> distance, angle1, angle2, angle3, rotation;
  Column<std::uint32_t> cells;
  Column<std::uint16_t> rotations;
};

/// Model points that may form pairs. A pair is kept if both points are visible from a common view
/// direction (Birdal and Ilic, 3DV 2015); with `views` empty, all pairs are kept.
struct PpfPoints {
  PointsView points;
  NormalsView normals;
  std::span<const ViewMask> views;
};

/// Mark one point of each set of points that the model's symmetries map onto each other. A table
/// then holds each pair once, not once per symmetric copy: a model of n-fold symmetry needs 1 / n
/// of the entries and votes.
///
/// A point is marked if none of its images lies farther along a fixed direction that no symmetry
/// preserves; for a rotational axis, if it is in a strip beside one half plane through the axis.
/// `margin` (about the sampling step) widens the choice, since samples do not map onto samples.
void choose_references(PointsView points, const Symmetry& symmetry, float margin,
                       std::span<std::uint8_t> is_reference) noexcept;

/// Unmark points so that the remaining marked ones of similar direction (within 45 degrees) lie
/// more than `distance` apart; of two closer ones, that of lower index stays. A scene's reference
/// point then still has a marked one within about `distance`.
void spread_references(PointsView points, NormalsView normals, float distance,
                       std::span<std::uint8_t> is_reference);

/// Pairs of the references [first, first + count) of a model.
struct PpfChunk {
  const PpfPoints& model;
  const PpfQuantization& quantization;
  std::size_t first, count;
};

/// Add the pairs of a chunk to counts[num_cells].
void count_ppf_pairs(const PpfChunk& chunk, PairScratch& scratch,
                     std::span<std::uint32_t> counts) noexcept;

/// counts: num_chunks rows of num_cells counts; replaced by each chunk's first write position per
/// cell. offsets: num_cells + 1. Returns the number of entries, or 0 if it does not fit 32 bits.
std::uint64_t scan_ppf_counts(std::span<std::uint32_t> counts, std::size_t num_chunks,
                              std::span<std::uint32_t> offsets) noexcept;

/// Write the entries of a chunk; positions[num_cells] advance.
/// Chunks write to disjoint ranges; within a cell, references ascend, as chunks are in order.
void fill_ppf_entries(const PpfChunk& chunk, PairScratch& scratch,
                      std::span<std::uint32_t> positions, std::span<PpfEntry> entries) noexcept;

/// Sort the entries of cells [first, first + count) by reference, then angle.
void sort_ppf_cells(std::span<const std::uint32_t> offsets, std::size_t first, std::size_t count,
                    std::span<PpfEntry> entries) noexcept;

}  // namespace trivet::kernels

/// A heap on a table as seen from above: where a body that is let down comes to rest.
#pragma once

#include <cstddef>

#include "storage/columns.hpp"
#include "storage/points.hpp"

namespace trivet::kernels {

/// For each cell of a square grid over the plane z = 0, how high what lies there reaches.
///
/// Bodies are given by samples of their surface. A cell counts as filled up to its highest sample,
/// from the plane on: no body slips under another. Samples outside the grid meet the bare plane.
class HeightField {
 public:
  /// A square of 2 * half_side, centred on the origin, in cells of edge `cell`; both > 0 [m].
  HeightField(float half_side, float cell);

  /// Find how far to lift a body along z so that it touches what is there and enters nothing.
  ///
  /// samples  n >= 1 positions on the body [m]; where no two neighbouring ones are farther apart
  /// than a cell, the
  ///          bodies are disjoint, as each sample is held against its cell and the eight around it
  /// Returns the least such lift [m]; negative where the body has to come down. Cost: O(n), no
  /// allocation.
  float rest(PointsView samples) const noexcept;

  /// Raise the field by a body whose samples are at `lift` above where they are given.
  void add(PointsView samples, float lift) noexcept;

 private:
  std::ptrdiff_t cell_of(float coordinate) const noexcept;

  float half_side_, cell_;
  std::ptrdiff_t side_;
  Column<float> top_;  // side_ * side_ cells, row by row along x
};

}  // namespace trivet::kernels

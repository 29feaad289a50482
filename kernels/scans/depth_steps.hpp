/// Steps of depth in a scan, and how many of them are abrupt.
#pragma once

#include <cstddef>

#include "kernels/scans/range_image.hpp"

namespace trivet::kernels {

/// Steps between two flat pieces of a row or a column.
struct StepCounts {
  std::size_t steps = 0;
  std::size_t abrupt = 0;  ///< with most of their height between two measured neighbors

  StepCounts& operator+=(const StepCounts& o) noexcept {
    steps += o.steps;
    abrupt += o.abrupt;
    return *this;
  }
};

/// Count the steps of 1.2 to 6 % of the range along rows [first_row, first_row + num_rows), or along
/// as many columns. A step lies between flat pieces of four pixels, twelve pixels away from its
/// largest jump, which may be over two pixels without a measurement: many sensors lose those that
/// see both sides of an edge. A slanted surface is none, nor is a step with a wider gap.
StepCounts count_steps_of_rows(const RangeImage& image, std::size_t first_row,
                               std::size_t num_rows);
StepCounts count_steps_of_columns(const RangeImage& image, std::size_t first_column,
                                  std::size_t num_columns);

}  // namespace trivet::kernels

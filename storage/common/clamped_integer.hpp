/// Conversion of floating-point numbers to integers within bounds.
#pragma once

#include <concepts>

namespace trivet {

/// The number truncated to an integer and clamped to [lowest, highest]; `lowest` for NaN. A count
/// computed from a file or a pose may be infinite or 0/0. A plain conversion of those is undefined
/// and mostly gives a huge number.
template <std::integral Integer, std::floating_point Number>
constexpr Integer clamped_integer(Number value, Integer lowest, Integer highest) noexcept {
  if (!(value > static_cast<Number>(lowest))) return lowest;
  return value < static_cast<Number>(highest) ? static_cast<Integer>(value) : highest;
}

}  // namespace trivet

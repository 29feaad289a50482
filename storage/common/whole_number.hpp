/// Floating-point numbers as whole ones, within bounds.
#pragma once

#include <concepts>

namespace trivet {

/// The whole number that a number is cut to, at least `lowest` and at most `highest`; `lowest` for
/// NaN. What a file or a pose makes of a count may be infinite or 0/0, of which a plain conversion is
/// undefined and mostly gives something huge.
template <std::integral Whole, std::floating_point Number>
constexpr Whole whole_number(Number value, Whole lowest, Whole highest) noexcept {
  if (!(value > static_cast<Number>(lowest))) return lowest;
  return value < static_cast<Number>(highest) ? static_cast<Whole>(value) : highest;
}

}  // namespace trivet

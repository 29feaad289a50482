/// What lengths are in.
#pragma once

namespace trivet {

/// A unit of lengths; a library has one for all its models.
enum class LengthUnit { meter, millimeter };

/// What to multiply a length in one unit by to have it in the other.
inline double unit_scale(LengthUnit from, LengthUnit to) noexcept {
  if (from == to) return 1;
  return from == LengthUnit::meter ? 1000 : 0.001;
}

}  // namespace trivet

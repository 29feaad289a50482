/// What lengths are in.
#pragma once

namespace trivet {

/// A unit of lengths; a library has one for all its models.
enum class LengthUnit { meter, millimeter };

/// Its symbol, as users and files write it: m or mm.
inline const char* unit_name(LengthUnit unit) noexcept {
  return unit == LengthUnit::meter ? "m" : "mm";
}

/// What to multiply a length in one unit by to have it in the other.
inline double unit_scale(LengthUnit from, LengthUnit to) noexcept {
  if (from == to) return 1;
  return from == LengthUnit::meter ? 1000 : 0.001;
}

}  // namespace trivet

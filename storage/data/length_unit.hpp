/// Units of length.
#pragma once

namespace trivet {

/// Unit of length, common to all models of a library.
enum class LengthUnit { meter, millimeter };

/// Symbol of the unit in files and messages: m or mm.
inline const char* unit_name(LengthUnit unit) noexcept {
  return unit == LengthUnit::meter ? "m" : "mm";
}

/// Factor that converts a length from one unit to the other.
inline double unit_scale(LengthUnit from, LengthUnit to) noexcept {
  if (from == to) return 1;
  return from == LengthUnit::meter ? 1000 : 0.001;
}

}  // namespace trivet

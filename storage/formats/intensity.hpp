/// Intensity of the points of a scan, from an intensity field or from colors.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "storage/common/columns.hpp"
#include "storage/formats/positions.hpp"

namespace trivet::formats {

/// Whether a field, a property or a column of this name holds intensities.
bool names_intensity(std::string_view name);

/// Names of color channels in files.
inline constexpr std::array<std::string_view, 3> kColorNames{"red", "green", "blue"};

/// Brightness of a color, in the range of its channels. Source: ITU-R BT.601, luma.
double brightness(double red, double green, double blue);

/// Brightness of a color packed into the three low bytes, red the highest of them.
double brightness(std::uint32_t color);

/// Brightness of colors as floats. colors  x, y, z are red, green, blue
Column<float> brightness(const Positions& colors);
Column<float> to_floats(const Column<double>& values);

}  // namespace trivet::formats

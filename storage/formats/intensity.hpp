/// How bright the points of a scan are: by a field of its own, else by their colors.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "storage/common/columns.hpp"
#include "storage/formats/positions.hpp"

namespace trivet::formats {

/// Whether a field, a property or a column of this name holds intensities.
bool names_intensity(std::string_view name);

/// How files call the shares of a color.
inline constexpr std::array<std::string_view, 3> kColorNames{"red", "green", "blue"};

/// Brightness of a color, in the range of its shares. Source: ITU-R BT.601, luma.
double brightness(double red, double green, double blue);

/// Of a color whose shares are the three low bytes, red the highest of them.
double brightness(std::uint32_t color);

/// As floats. colors  x, y, z are red, green, blue
Column<float> brightness(const Positions& colors);
Column<float> to_floats(const Column<double>& values);

}  // namespace trivet::formats

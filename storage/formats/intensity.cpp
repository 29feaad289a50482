#include "storage/formats/intensity.hpp"

#include <algorithm>
#include <string>

#include "storage/files/text.hpp"

namespace trivet::formats {

bool names_intensity(std::string_view name) {
  constexpr std::array<std::string_view, 5> kNames{"intensity", "scalar_intensity", "reflectance",
                                                   "reflectivity", "remission"};
  return std::ranges::find(kNames, lower_case(name)) != kNames.end();
}

double brightness(double red, double green, double blue) {
  return 0.299 * red + 0.587 * green + 0.114 * blue;
}

double brightness(std::uint32_t color) {
  const auto share = [&](unsigned shift) { return static_cast<double>(color >> shift & 0xFFU); };
  return brightness(share(16), share(8), share(0));
}

Column<float> brightness(const Positions& colors) {
  Column<float> values(colors.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = to_float(brightness(colors.x[i], colors.y[i], colors.z[i]));
  return values;
}

Column<float> to_floats(const Column<double>& values) {
  Column<float> floats(values.size());
  std::ranges::transform(values, floats.begin(), to_float);
  return floats;
}

}  // namespace trivet::formats

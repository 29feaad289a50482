#include "engine/loaded_library/score_json.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "kernels/scoring/pose_score.hpp"

namespace trivet::engine {

void check_format(const JsonNode& root, std::string_view format, int version,
                  std::string_view writer) {
  const JsonNode found = root.at("format");
  if (found.string() != format)
    found.refuse(fmt::format("expected \"{}\", as `{}` writes it", format, writer));
  (void)root.at("version").integer(version, version);
}

float number_within(const JsonNode& node, double low, double high) {
  const double value = node.number();
  if (value < low || value > high)
    node.refuse(fmt::format("expected a number from {} to {}", low, high));
  return static_cast<float>(value);
}

void for_each_part(const JsonNode& parts,
                   const std::function<void(std::size_t part, const JsonNode& value)>& visit) {
  using kernels::kScoreParts;
  for (std::size_t part = 0; part < kScoreParts.size(); ++part)
    visit(part, parts.at(kScoreParts[part].name));
  for (const auto& [name, value] : parts.members()) {
    if (std::ranges::find(kScoreParts, name, &kernels::ScorePart::name) == kScoreParts.end())
      value.refuse(fmt::format("expected the {} parts of a score alone", kScoreParts.size()));
  }
}

}  // namespace trivet::engine

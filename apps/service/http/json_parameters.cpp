#include "apps/service/http/json_parameters.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <vector>

namespace trivet::apps::service {
namespace {

std::string text_of(const JsonNode& value) {
  if (value.is_string()) return value.string();
  if (value.is_boolean()) return value.boolean() ? "true" : "false";
  if (value.is_array()) {
    std::vector<std::string> texts;
    for (const JsonNode& element : value.elements()) {
      if (element.is_array()) element.refuse("expected a text or a number");
      texts.push_back(text_of(element));
    }
    return fmt::format("{}", fmt::join(texts, ","));
  }
  return fmt::format("{}", value.number());
}

}  // namespace

Parameters parameters_of(const JsonNode& object, std::initializer_list<std::string_view> without) {
  Parameters parameters;
  for (const auto& [name, value] : object.members()) {
    if (std::ranges::find(without, name) != without.end()) continue;
    if (name == "camera" && !value.is_array() && !value.is_string()) {
      const Camera c = value.camera();
      parameters.emplace_back(name,
                              fmt::format("{},{},{},{},{}", c.fx, c.fy, c.cx, c.cy, c.depth_scale));
    } else {
      parameters.emplace_back(name, text_of(value));
    }
  }
  return parameters;
}

}  // namespace trivet::apps::service

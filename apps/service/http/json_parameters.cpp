#include "apps/service/http/json_parameters.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <vector>

#include "storage/formats/camera_json.hpp"

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

void add_camera(const Camera& c, Parameters& parameters) {
  parameters.emplace_back("camera",
                          fmt::format("{},{},{},{},{}", c.fx, c.fy, c.cx, c.cy, c.depth_scale));
  if (c.depth == DepthKind::ray) parameters.emplace_back("depth", "ray");
  if (const LensDistortion& d = c.distortion; !d.none()) {
    parameters.emplace_back("distortion", fmt::format("{},{},{},{},{},{},{},{}", d.k1, d.k2, d.p1,
                                                      d.p2, d.k3, d.k4, d.k5, d.k6));
  }
  if (c.width > 0 && c.height > 0)
    parameters.emplace_back("image-size", fmt::format("{},{}", c.width, c.height));
}

Parameters parameters_of(const JsonNode& object, std::initializer_list<std::string_view> without) {
  Parameters parameters;
  for (const auto& [name, value] : object.members()) {
    if (std::ranges::find(without, name) != without.end()) continue;
    if (name == "camera" && !value.is_array() && !value.is_string()) {
      add_camera(parse_camera(value), parameters);
    } else {
      parameters.emplace_back(name, text_of(value));
    }
  }
  return parameters;
}

}  // namespace trivet::apps::service

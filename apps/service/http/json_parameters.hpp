/// Options given as JSON, converted to the parameters of a target.
#pragma once

#include <initializer_list>
#include <string_view>

#include "apps/service/http/query.hpp"
#include "storage/files/json_file.hpp"

namespace trivet::apps::service {

/// Adds a camera as the parameters camera, depth, distortion and image-size, without default
/// values.
void add_camera(const Camera& camera, Parameters& parameters);

/// Converts the members of an object to parameters, except the excluded names. Accepts strings,
/// numbers, booleans, lists of these, and cameras as read by parse_camera. Throws JsonFault.
Parameters parameters_of(const JsonNode& object,
                         std::initializer_list<std::string_view> without = {});

}  // namespace trivet::apps::service

/// Options that come as JSON, as the parameters that they are in a target.
#pragma once

#include <initializer_list>
#include <string_view>

#include "apps/service/http/query.hpp"
#include "storage/files/json_file.hpp"

namespace trivet::apps::service {

/// A camera as the parameters camera, depth, distortion and image-size; what is as usual is left out.
void add_camera(const Camera& camera, Parameters& parameters);

/// Members of an object as parameters, but for those named: texts, numbers, true and false, lists
/// of these, and cameras as parse_camera takes them. Throws JsonFault.
Parameters parameters_of(const JsonNode& object,
                         std::initializer_list<std::string_view> without = {});

}  // namespace trivet::apps::service

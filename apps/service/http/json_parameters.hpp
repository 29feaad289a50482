/// Options that come as JSON, as the parameters that they are in a target.
#pragma once

#include <initializer_list>
#include <string_view>

#include "apps/service/http/query.hpp"
#include "storage/files/json_file.hpp"

namespace trivet::apps::service {

/// Members of an object as parameters, but for those named: texts, numbers, true and false, lists
/// of these, and cameras as {"fx", "fy", "cx", "cy", "depth_scale"}. Throws JsonFault.
Parameters parameters_of(const JsonNode& object,
                         std::initializer_list<std::string_view> without = {});

}  // namespace trivet::apps::service

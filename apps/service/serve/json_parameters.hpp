/// Options that come as JSON, as the parameters that they are in a target.
#pragma once

#include <string_view>

#include "apps/service/http/query.hpp"
#include "storage/files/json_file.hpp"

namespace trivet::apps::service {

/// Members of an object as parameters, but for one of them: texts, numbers, true and false, lists
/// of these, and cameras as {"fx", "fy", "cx", "cy", "depth_scale"}. Throws JsonFault.
Parameters parameters_of(const JsonNode& object, std::string_view without = {});

}  // namespace trivet::apps::service

/// The words for what answers of the service name.
#pragma once

#include <nlohmann/json.hpp>

namespace trivet::apps::service {

/// {"methods": by the name of a detection's method, "robot_conventions": by name, "score": {"begin",
/// "others", "sum"}, each with label and meaning}
nlohmann::ordered_json word_table();

}  // namespace trivet::apps::service

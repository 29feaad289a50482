/// What programs are told of a model of a library.
#pragma once

#include <nlohmann/json.hpp>

#include "storage/model.hpp"

namespace trivet::apps::service {

/// {"name", "diameter", "symmetry", "near_symmetry"}; lengths are in the library's unit.
nlohmann::ordered_json model_json(const Model& model);

}  // namespace trivet::apps::service

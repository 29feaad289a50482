/// A model of a library, as JSON for programs.
#pragma once

#include <nlohmann/json.hpp>

#include "storage/data/model.hpp"

namespace trivet::apps::service {

/// As openapi.json has axes: "direction", "point", and "turn_deg", which is null for any turn.
///
/// turn  the smallest [rad]; 0: any
nlohmann::ordered_json turn_axis_json(const Symmetry::Axis& axis, float turn);

/// {"name", "diameter", "symmetry", "near_symmetry"}; lengths are in the library's unit.
nlohmann::ordered_json model_json(const Model& model);

}  // namespace trivet::apps::service

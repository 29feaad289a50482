/// A model of a library as JSON.
#pragma once

#include <nlohmann/json.hpp>

#include "storage/data/model.hpp"

namespace trivet::apps::service {

/// An axis as defined in openapi.json: "direction", "point", and "turn_deg", which is null for a
/// rotation by any angle.
///
/// turn  smallest rotation [rad]; 0: any
nlohmann::ordered_json turn_axis_json(const Symmetry::Axis& axis, float turn);

/// {"name", "diameter", "symmetry", "near_symmetry"}. Lengths are in the library's unit.
nlohmann::ordered_json model_json(const ModelInfo& model);

}  // namespace trivet::apps::service

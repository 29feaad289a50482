/// What a manifest declares of the symmetry of a model.
#pragma once

#include <optional>

#include "storage/data/model.hpp"
#include "storage/files/json_file.hpp"

namespace trivet {

/// Of "symmetries" and "symmetry_axis", in the unit that they are given in. Absent when both are
/// empty. Throws JsonFault.
std::optional<Symmetry> parse_symmetry(const JsonNode& model);

}  // namespace trivet

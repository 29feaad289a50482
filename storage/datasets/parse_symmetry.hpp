/// Parsing of the symmetry that a manifest declares for a model.
#pragma once

#include <optional>

#include "storage/data/model.hpp"
#include "storage/files/json_file.hpp"

namespace trivet {

/// Parses "symmetries" and "symmetry_axis", in the unit of the manifest. Absent if both are empty.
/// Throws JsonFault.
std::optional<Symmetry> parse_symmetry(const JsonNode& model);

}  // namespace trivet

/// What all files about scores have in common.
#pragma once

#include <cstddef>
#include <functional>
#include <string_view>

#include "storage/files/json_file.hpp"

namespace trivet::engine {

/// Refuse a document of another format or version.
void check_format(const JsonNode& root, std::string_view format, int version,
                  std::string_view writer);

/// A number within these bounds, both included.
float number_within(const JsonNode& node, double low, double high);

/// Visit the members that are named after the parts of a score, by their indices. Refuses an object
/// that lacks one of them or has others.
void for_each_part(const JsonNode& parts,
                   const std::function<void(std::size_t part, const JsonNode& value)>& visit);

}  // namespace trivet::engine

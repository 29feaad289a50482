/// Common parts of all score files.
#pragma once

#include <cstddef>
#include <functional>
#include <string_view>

#include "storage/files/json_file.hpp"

namespace trivet::engine {

/// Reject a document of another format or version.
void check_format(const JsonNode& root, std::string_view format, int version,
                  std::string_view writer);

/// A number within these bounds, both included.
float number_within(const JsonNode& node, double low, double high);

/// Visit the members named after the parts of a score, by their indices. Rejects an object with
/// missing or additional members.
void for_each_part(const JsonNode& parts,
                   const std::function<void(std::size_t part, const JsonNode& value)>& visit);

}  // namespace trivet::engine

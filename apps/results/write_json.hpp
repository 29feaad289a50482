/// Results as JSON, written to a file or to standard output.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "storage/common/result.hpp"

namespace trivet::apps {

/// Writes a document to a file, which appears whole or not at all; "-" is standard output.
/// Errors: cannot_create, io.
Result<void> write_json(const std::string& target, const nlohmann::ordered_json& document);

}  // namespace trivet::apps

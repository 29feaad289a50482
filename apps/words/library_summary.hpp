/// The contents of a library, as text and as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "storage/library/library.hpp"

namespace trivet::apps {

/// The file, then a table with a row for each model; lengths in the library's unit.
std::string library_text(const Library& library);

/// The same, with details that do not fit into a table. `parameters` is copied from the file: an
/// object, or a text if it is not JSON.
nlohmann::ordered_json library_json(const Library& library);

}  // namespace trivet::apps

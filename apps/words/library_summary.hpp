/// What a library holds, for people and for programs.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "storage/library/library.hpp"

namespace trivet::apps {

/// The file, then a table with a row for each model; lengths in the library's unit.
std::string library_text(const Library& library);

/// The same, and what a table has no room for. `parameters` is what the file says: an object, or a
/// text where it is no JSON.
nlohmann::ordered_json library_json(const Library& library);

}  // namespace trivet::apps

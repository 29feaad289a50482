/// The JSON that `trivet recognize --json` writes.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "engine/recognise.hpp"

namespace trivet::apps {

/// One element of "scenes".
nlohmann::ordered_json scene_json(const std::string& file, const SceneResult& result);

}  // namespace trivet::apps

/// What a search found, as its user sees it.
#pragma once

#include "engine/recognition/search_scene.hpp"
#include "engine/scene/prepare_scene.hpp"
#include "storage/library/library.hpp"

namespace trivet::engine {

/// Name the models, bring lengths into the scene file's unit and detections into the order of
/// their scores.
///
/// stats  of the search; get what the scene's noise and sensor were
SceneResult report(const Library& library, const PreparedScene& scene, const SearchResult& found,
                   SceneStats stats);

}  // namespace trivet::engine

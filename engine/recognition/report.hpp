/// Conversion of search results for the user.
#pragma once

#include "engine/recognition/search_scene.hpp"
#include "engine/scene/prepare_scene.hpp"
#include "storage/library/library.hpp"

namespace trivet::engine {

/// Add model names, convert lengths to the scene file's unit and sort detections by score.
///
/// stats  statistics of the search; receive the scene's noise and sensor model
SceneResult report(const Library& library, const PreparedScene& scene, const SearchResult& found,
                   SceneStats stats);

}  // namespace trivet::engine

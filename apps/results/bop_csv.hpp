/// Detections with the ids of a BOP data set, as written by `trivet recognize --bop-csv` and read
/// by `trivet evaluate --detections`.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/inputs/inputs.hpp"
#include "engine/recognition/recognize.hpp"
#include "storage/datasets/bop_results.hpp"
#include "storage/library/library.hpp"

namespace trivet::apps {

/// A warning about a results file whose name the tools of the benchmark would not recognize.
std::optional<std::string> bop_name_warning(const std::filesystem::path& file);

/// Checks before recognition that every detection will have its ids. Each scene must belong to a
/// BOP data set, with ids that no other scene has. Each model must have its name of the data set,
/// since a library knows no object ids (obj_000001, as named by `trivet train DATASET`).
///
/// models   names to search for; empty: all of the library
/// Errors: usage (names the scene or the model).
Result<void> check_bop_ids(const SceneInputs& scenes, const Library& library,
                           std::span<const std::string> models);

/// Adds the detections of a scene, with the seconds of the whole scene. Pre: check_bop_ids; a scene
/// of a BOP data set is in mm.
void add_bop_results(const SceneInputs& scenes, std::size_t index, const SceneResult& found,
                     std::vector<BopResult>& results);

/// Reads the results of a data set's scenes, one per scene of the manifest; none for images that
/// the file does not contain.
/// Errors: those of read_bop_results; usage (the manifest is no BOP data set), bad_data (an object
/// that the data set does not have).
Result<std::vector<std::optional<SceneResult>>> read_bop_detections(
    const std::filesystem::path& file, const Manifest& manifest);

}  // namespace trivet::apps

/// Detections under the numbers of a BOP data set, as `trivet recognize --bop-csv` writes and
/// `trivet evaluate --detections` reads them.
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

/// What to tell of a file of results that the benchmark's tools would not know by its name.
std::optional<std::string> bop_name_warning(const std::filesystem::path& file);

/// Check, before anything is recognized, that every detection will have its numbers: each scene
/// those of a BOP data set, no two the same, and each model the name that it has there, as a
/// library knows no object ids (obj_000001, as `trivet train DATASET` names it).
///
/// models   names to look for; empty: all of the library
/// Errors: usage (names the scene or the model).
Result<void> check_bop_ids(const SceneInputs& scenes, const Library& library,
                           std::span<const std::string> models);

/// Add the detections of a scene, with the seconds that the whole scene took.
/// Pre: check_bop_ids; a scene of a BOP data set is in mm.
void add_bop_results(const SceneInputs& scenes, std::size_t index, const SceneResult& found,
                     std::vector<BopResult>& results);

/// Read the results of a data set's scenes, one a scene of the manifest; none for images that the
/// file does not name. Errors: those of read_bop_results; usage (the manifest is no BOP data set),
/// bad_data (an object that the data set does not have).
Result<std::vector<std::optional<SceneResult>>> read_bop_detections(
    const std::filesystem::path& file, const Manifest& manifest);

}  // namespace trivet::apps

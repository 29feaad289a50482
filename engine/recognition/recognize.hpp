/// Recognition of a library's models in a scene.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "engine/common/progress.hpp"
#include "engine/loaded_library/recognizer.hpp"
#include "engine/options/recognize_options.hpp"
#include "engine/results/recognize_result.hpp"
#include "engine/scene/read_scene.hpp"
#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"
#include "storage/data/length_unit.hpp"

namespace trivet {

/// Recognize the models in one scene in memory. Same input, same bytes for any number of threads.
/// Nothing is found with fewer than 50 measurements. If a scene is too large for the models because
/// of at most a hundredth of its points, these are left out (SceneStats::num_stray).
/// Errors: bad_data (sizes that cannot match the library's unit), usage (unknown model name),
/// internal (no memory for ray tracing), changed (others changed the library in place: see
/// Library::unchanged).
Result<SceneResult> recognize(const Recognizer& recognizer, const Cloud& scene,
                              const SceneInput& input, const RecognizeOptions& options,
                              std::stop_token stop = {});

/// Read and recognize many scenes, a few in flight at a time. `emit` receives each result once, in
/// the order of the inputs, from one thread at a time. `fail` receives, in the same order, the
/// errors of scenes that could not be read or recognized, and the others continue. Without `fail`,
/// the run ends.
/// Errors: the first one, in the order of the inputs, that `fail` does not accept; usage and
/// changed, which affect all scenes; resumable when stopped.
Result<void> recognize_all(const Recognizer& recognizer, std::span<const SceneInput> scenes,
                           const RecognizeOptions& options, const Progress& progress,
                           const std::function<void(std::size_t index, const SceneResult&)>& emit,
                           const std::function<void(std::size_t index, const Error&)>& fail = {});

}  // namespace trivet

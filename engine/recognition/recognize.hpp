/// Recognize the models of a library in a scene.
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

/// Find the models in one scene that is already in memory. Same input, same bytes for any number of
/// threads. With fewer than 50 measurements nothing is found. Of a scene that is too large for the
/// models by a hundredth of its points at most, these are left out (SceneStats::num_stray).
/// Errors: bad_data (sizes that cannot match the library's unit), usage (unknown model name), internal
/// (no memory for ray tracing), changed (others changed the library in place: see Library::unchanged).
Result<SceneResult> recognize(const Recognizer& recognizer, const Cloud& scene,
                              const SceneInput& input, const RecognizeOptions& options,
                              std::stop_token stop = {});

/// Read and recognize many scenes, a few in flight at a time. `emit` gets each result once, in the
/// order of the inputs, from one thread at a time; `fail`, in the same order, what kept a scene from
/// being read or recognized, and the others go on. Without it they do not.
/// Errors: the first one met, in the order of the inputs, that `fail` does not take; usage and
/// changed, which would meet all scenes; resumable when stopped.
Result<void> recognize_all(const Recognizer& recognizer, std::span<const SceneInput> scenes,
                           const RecognizeOptions& options, const Progress& progress,
                           const std::function<void(std::size_t index, const SceneResult&)>& emit,
                           const std::function<void(std::size_t index, const Error&)>& fail = {});

}  // namespace trivet

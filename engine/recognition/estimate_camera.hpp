/// Recognition of scenes whose cameras may be incorrect.
#pragma once

#include <span>
#include <vector>

#include "engine/recognition/recognize.hpp"

namespace trivet {

/// Recognize all scenes. If the checks of all scenes of a camera agree that it is off, correct it
/// and recognize all scenes again, at most twice. All results are kept in memory.
///
/// scenes  depth images receive the cameras that their results were found with
/// Results are in the order of the scenes, with the error of each that failed. Errors: those of
/// recognize_all.
Result<std::vector<Result<SceneResult>>> recognize_estimating_camera(
    const Recognizer& recognizer, std::span<SceneInput> scenes, const RecognizeOptions& options,
    const Progress& progress);

}  // namespace trivet

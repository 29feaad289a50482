/// Recognize scenes whose cameras may have been given wrongly.
#pragma once

#include <span>
#include <vector>

#include "engine/recognition/recognize.hpp"

namespace trivet {

/// Recognize all scenes; where the checks of all scenes of a camera say that it is off, correct it
/// and recognize all once more, twice at most. All results are held in memory.
///
/// scenes  depth images get the cameras that their results were found with
/// Results are in the order of the scenes, with the error of each that failed. Errors: of
/// recognize_all.
Result<std::vector<Result<SceneResult>>> recognize_estimating_camera(
    const Recognizer& recognizer, std::span<SceneInput> scenes, const RecognizeOptions& options,
    const Progress& progress);

}  // namespace trivet

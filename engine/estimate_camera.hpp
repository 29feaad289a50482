/// Recognise scenes whose cameras may have been given wrongly.
#pragma once

#include <span>
#include <vector>

#include "engine/recognise.hpp"

namespace trivet {

/// Recognise all scenes; where the checks of all scenes of a camera say that it is off, correct it
/// and recognise all once more, twice at most. All results are held in memory.
///
/// scenes  depth images get the cameras that their results were found with
/// Results are in the order of the scenes. Errors: of recognise_all.
Result<std::vector<SceneResult>> recognise_estimating_camera(const Recogniser& recogniser,
                                                             std::span<SceneInput> scenes,
                                                             const RecogniseOptions& options,
                                                             const Progress& progress);

}  // namespace trivet

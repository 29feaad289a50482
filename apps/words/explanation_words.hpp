/// Why a model is found at a place, or is not, in the words of all pages.
#pragma once

#include <string>

#include "engine/recognition/recognize.hpp"

namespace trivet::apps {

/// A sentence without its subject, the model: "was refined here, but ...". `explanation` belongs to
/// the result, `options` are those of the recognition.
std::string explanation_words(const SceneResult& result, const ModelExplanation& explanation,
                              const kernels::ScoreModel& score, const RecognizeOptions& options);

/// The number of poses that reached each stage: "12 proposed, 3 looked at, 1 refined, none tested by
/// rays".
std::string stage_words(const ModelExplanation& explanation);

/// Lines of text about the requested place; empty without one.
std::string explanation_text(const SceneResult& result, const kernels::ScoreModel& score,
                             const RecognizeOptions& options);

}  // namespace trivet::apps

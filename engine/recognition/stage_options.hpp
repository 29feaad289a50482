/// The options of recognition as its stages take them: here ends what is left out by name.
#pragma once

#include "engine/recognition/recognize.hpp"
#include "engine/scene/prepare_scene.hpp"
#include "engine/selection/select_detections.hpp"
#include "engine/verification/model_stages.hpp"

namespace trivet::engine {

/// Each of them takes options that ablate() has seen.
PrepareOptions prepare_options(const RecognizeOptions& options);
LargePlanes large_planes(const RecognizeOptions& options);
SettleOptions settle_options(const RecognizeOptions& options);
SelectOptions select_options(const RecognizeOptions& options);
/// Whether what is chosen is held against its alternatives and other answers.
bool compares_alternatives(const RecognizeOptions& options);

}  // namespace trivet::engine

/// One scene of a recognition report: pictures, tables and the reasons.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "apps/report/pictures.hpp"
#include "apps/report/recognition_report.hpp"

namespace trivet::apps {

/// The figure of scene `s` with the detected models, the rejected models, the parts of their
/// scores, times and counts. `models` are those of the library. If a scene contains too little to
/// be drawn, a message replaces the pictures. Errors: of reading, drawing and writing.
Result<std::string> recognition_figure(const RecognitionReport& report, std::size_t s,
                                       std::span<const EvaluationMesh> models, PictureStore& store);

}  // namespace trivet::apps

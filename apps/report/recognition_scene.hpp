/// One scene of a report of recognition: pictures, tables and the reasons.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "apps/report/pictures.hpp"
#include "apps/report/recognition_report.hpp"

namespace trivet::apps {

/// The figure of scene `s` with the models found, the models rejected, what their scores are made
/// of, times and counts. `models` are the library's. A scene that shows too little to be drawn says
/// so in the pictures' place. Errors: of reading, drawing and writing.
Result<std::string> recognition_figure(const RecognitionReport& report, std::size_t s,
                                       std::span<const EvaluationMesh> models, PictureStore& store);

}  // namespace trivet::apps

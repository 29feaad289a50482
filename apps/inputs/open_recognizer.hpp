/// A library, and the score that a cell was calibrated to.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "engine/recognizer.hpp"
#include "storage/result.hpp"

namespace CLI {
class App;
}

namespace trivet::apps {

/// --calibration. `file` must live as long as the command.
void add_calibration_option(CLI::App& command, std::string& file);

/// Open a library with the score of a calibration, or with the default one where there is no file.
/// Errors: of open_library and read_calibration.
Result<Recognizer> open_recognizer(const std::string& library, const std::string& calibration);

/// What results tell of a score: the name of a calibrated one, else null.
nlohmann::ordered_json calibration_json(const Recognizer& recognizer);

}  // namespace trivet::apps

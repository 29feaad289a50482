#include "apps/inputs/open_recognizer.hpp"

#include <CLI/CLI.hpp>
#include <utility>

#include "engine/default_score.hpp"
#include "engine/evaluation/score_calibration.hpp"
#include "storage/library.hpp"

namespace trivet::apps {

void add_calibration_option(CLI::App& command, std::string& file) {
  command
      .add_option("--calibration", file,
                  "Score as `trivet calibrate` adapted it to these scans, from this file")
      ->type_name("FILE");
}

Result<Recognizer> open_recognizer(const std::string& library, const std::string& calibration) {
  kernels::ScoreModel score = default_score();
  if (!calibration.empty()) {
    const Result<ScoreCalibration> read = read_calibration(calibration);
    if (!read) return read.error();
    score = calibrated_score(*read);
  }
  Result<Library> opened = open_library(library);
  if (!opened) return opened.error();
  return Recognizer(std::move(*opened), score);
}

nlohmann::ordered_json calibration_json(const Recognizer& recognizer) {
  const std::string name = score_name(recognizer.score());
  if (name == score_name(default_score())) return nullptr;
  return name;
}

}  // namespace trivet::apps

#include "apps/inputs/open_recognizer.hpp"

#include <CLI/CLI.hpp>
#include <utility>

#include "engine/loaded_library/default_score.hpp"
#include "engine/loaded_library/score_calibration.hpp"
#include "storage/library/library.hpp"

namespace trivet::apps {

void add_open_options(CLI::App& command, OpenOptions& options) {
  command
      .add_option("--calibration", options.calibration,
                  "Score as `trivet calibrate` adapted it to these scans, from this file")
      ->type_name("FILE");
  command.add_option("--memory", options.memory_mb, kMemoryHelp)
      ->type_name("N")
      ->check(CLI::Range(16, 1 << 20))
      ->capture_default_str();
  command.add_flag("--verify", options.verify,
                   "Check all of the library first; else each model is checked when it is first "
                   "used");
}

Result<Recognizer> open_recognizer(const std::string& library, const OpenOptions& options) {
  kernels::ScoreModel score = default_score();
  if (!options.calibration.empty()) {
    const Result<ScoreCalibration> read = read_calibration(options.calibration);
    if (!read) return read.error();
    score = calibrated_score(*read);
  }
  Result<Library> opened = options.verify ? verify_library(library) : open_library(library);
  if (!opened) return opened.error();
  return Recognizer(std::move(*opened), score, {std::size_t{options.memory_mb} << 20U});
}

nlohmann::ordered_json calibration_json(const Recognizer& recognizer) {
  const std::string name = score_name(recognizer.score());
  if (name == score_name(default_score())) return nullptr;
  return name;
}

}  // namespace trivet::apps

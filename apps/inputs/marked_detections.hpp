/// Results of `trivet recognize --json` in which detections are marked right or wrong.
#pragma once

#include <filesystem>

#include "engine/calibration/calibrate_score.hpp"
#include "storage/common/result.hpp"

namespace trivet::apps {

/// Adds the detections of a result that have a member "right", true or false; others are not
/// counted. A scene is a scan.
/// Errors: missing_input, io; bad_data (names the place: an invalid mark, a part of the score that
/// is missing or no number, a result without any mark).
Result<void> add_marked(const std::filesystem::path& file, Outcomes& outcomes);

}  // namespace trivet::apps

/// A score adapted to a cell, stored in a small file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "kernels/scoring/adapt_score.hpp"
#include "storage/common/result.hpp"

namespace trivet {

struct ScoreCalibration {
  kernels::ScoreAdaptation adaptation{};  ///< relative to default_score()
  /// Numbers of the scans and outcomes that it was fitted to.
  std::uint32_t num_scans = 0, num_right = 0, num_wrong = 0;
  bool operator==(const ScoreCalibration&) const = default;
};

/// Checksum of a score's numbers, as 16 hexadecimal digits.
std::string score_name(const kernels::ScoreModel& score);

/// default_score() with the calibration applied.
kernels::ScoreModel calibrated_score(const ScoreCalibration& calibration) noexcept;

/// Write a calibration as JSON, with the names of the score before and after it. Errors:
/// cannot_create, io.
Result<void> write_calibration(const std::filesystem::path& file,
                               const ScoreCalibration& calibration);

/// Read a calibration. Errors: missing_input, io; bad_data (names the value, what was expected and
/// what was found: no calibration, a calibration of another version of the score, missing or
/// unknown parts, numbers out of range, a score that would raise a pose by more than
/// kernels::kMaxRaise).
Result<ScoreCalibration> read_calibration(const std::filesystem::path& file);

}  // namespace trivet

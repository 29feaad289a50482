/// A score adapted to a cell, kept in a small file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "kernels/verification/adapt_score.hpp"
#include "storage/common/result.hpp"

namespace trivet {

struct ScoreCalibration {
  kernels::ScoreAdaptation adaptation{};                      ///< of default_score()
  std::uint32_t num_scans = 0, num_right = 0, num_wrong = 0;  ///< that it was made from
  bool operator==(const ScoreCalibration&) const = default;
};

/// 16 hexadecimal digits that differ where a score's numbers do.
std::string score_name(const kernels::ScoreModel& score);

/// What default_score() becomes by it.
kernels::ScoreModel calibrated_score(const ScoreCalibration& calibration) noexcept;

/// Write a calibration as JSON, with the name of the score that it is of and of the one that it
/// makes. Errors: cannot_create, io.
Result<void> write_calibration(const std::filesystem::path& file,
                               const ScoreCalibration& calibration);

/// Errors: missing_input, io; bad_data (names the value, what was expected and what was found: no
/// calibration, one of another version of the score, parts that are missing or unknown, numbers
/// beyond their range, a score that would raise a pose by more than kernels::kMaxRaise).
Result<ScoreCalibration> read_calibration(const std::filesystem::path& file);

}  // namespace trivet

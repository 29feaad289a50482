/// Fit of the score to scenes with known ground truth.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/common/progress.hpp"
#include "engine/loaded_library/recognizer.hpp"
#include "engine/options/recognize_options.hpp"
#include "kernels/scoring/pose_score.hpp"
#include "storage/common/result.hpp"
#include "storage/datasets/manifest.hpp"

namespace trivet {

/// Detections of any score, and whether they were correct.
struct Outcomes {
  std::vector<kernels::ScoreParts> parts;
  std::vector<std::uint8_t> right;
  std::vector<std::uint32_t> scan;  ///< index of each detection's scan in `scans`
  std::vector<std::string> scans;   ///< processed scans, including those without detections
};

/// Recognize the scenes of a manifest, and add the detections that count to `outcomes`. These are
/// the detections of any score that remain when the best ones explain their pixels. Detections that
/// are an object of their model turned by more than 45 degrees are excluded. Truths of models that
/// the library does not contain are unknown objects. Errors: those of recognize_all and evaluate.
Result<void> add_outcomes(const Recognizer& recognizer, const Manifest& manifest,
                          RecognizeOptions options, const Progress& progress, Outcomes& outcomes);

}  // namespace trivet

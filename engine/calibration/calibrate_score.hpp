/// Learn from scenes of known truth how sure a detection may be.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/common/progress.hpp"
#include "engine/loaded_library/recognizer.hpp"
#include "engine/options/recognize_options.hpp"
#include "kernels/verification/pose_score.hpp"
#include "storage/common/result.hpp"
#include "storage/datasets/manifest.hpp"

namespace trivet {

/// Detections of any score, and whether they were right.
struct Outcomes {
  std::vector<kernels::ScoreParts> parts;
  std::vector<std::uint8_t> right;
  std::vector<std::uint32_t> scan;  ///< index of each in `scans`
  std::vector<std::string> scans;   ///< that were looked at, also where nothing was found
};

/// Recognize the scenes of a manifest, and add the detections that count to `outcomes`: those that
/// remain when the best explain their pixels, down to any score, but for those that are an object
/// of their model turned by more than 45 degrees. Truths of models that the library does not have
/// are unknown objects. Errors: of recognize_all and evaluate.
Result<void> add_outcomes(const Recognizer& recognizer, const Manifest& manifest,
                          RecognizeOptions options, const Progress& progress, Outcomes& outcomes);

}  // namespace trivet

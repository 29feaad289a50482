/// A page that presents the detections and rejected poses of one recognition for review.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "engine/recognition/recognize.hpp"

namespace trivet::apps {

/// The number of rejected poses per model on the page: RecognizeOptions::max_rejected.
inline constexpr std::uint32_t kRejectedPerModel = 3;

struct RecognitionReport {
  const Recognizer& recognizer;
  const RecognizeOptions& options;
  std::span<const SceneInput> scenes;
  std::span<const SceneResult> results;  ///< one per scene
  std::string command;  ///< command that reproduces this result, quoted for a shell
};

/// Writes folder/index.html: each scene with the detected models drawn in, the parts of their
/// scores, the rejected poses with the reason, times and options. The pictures are in
/// folder/pictures. While they make up to about 20 MB, they are also embedded in the page, which is
/// then self-contained. The page appears whole or not at all.
/// Errors: of reading and drawing the scenes; cannot_create, io; resumable when stopped.
Result<void> write_recognition_report(const std::filesystem::path& folder,
                                      const RecognitionReport& report, const Progress& progress);

}  // namespace trivet::apps

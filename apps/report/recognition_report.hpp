/// A page that shows what one recognition found and what it rejected, for people to judge.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "engine/recognition/recognize.hpp"

namespace trivet::apps {

/// How many rejected poses of a model the page tells of: RecognizeOptions::max_rejected.
inline constexpr std::uint32_t kRejectedPerModel = 3;

struct RecognitionReport {
  const Recognizer& recognizer;
  const RecognizeOptions& options;
  std::span<const SceneInput> scenes;
  std::span<const SceneResult> results;  ///< one a scene
  std::string command;                   ///< that leads to this result, as a shell takes it
};

/// Write folder/index.html: each scene with the found models drawn in, what their scores are made
/// of, the rejected poses with the reason, times and options. The pictures are in folder/pictures;
/// while they make up to about 20 MB they are within the page, too, which then stands alone. The
/// page appears whole or not at all. Errors: of reading and drawing the scenes; cannot_create, io;
/// resumable when stopped.
Result<void> write_recognition_report(const std::filesystem::path& folder,
                                      const RecognitionReport& report, const Progress& progress);

}  // namespace trivet::apps

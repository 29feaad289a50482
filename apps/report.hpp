/// A page that shows what was found, for people to judge.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "engine/evaluate.hpp"
#include "engine/progress.hpp"
#include "storage/library.hpp"
#include "storage/manifest.hpp"

namespace trivet::apps {

/// Write folder/index.html: sums, tables, and each scene with its detections drawn in. The page is
/// one file that needs nothing else; it appears whole or not at all. Errors: of reading and drawing
/// the scenes; cannot_create, io; resumable when stopped.
Result<void> write_report(const std::filesystem::path& folder, const Library& library,
                          const Manifest& manifest, const Evaluation& evaluation,
                          std::span<const std::optional<SceneResult>> results,
                          const Progress& progress);

}  // namespace trivet::apps

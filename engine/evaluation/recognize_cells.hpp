/// Many scenes by many libraries and options, for studies.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>

#include "engine/common/progress.hpp"
#include "engine/evaluation/degrade_scene.hpp"
#include "engine/options/recognize_options.hpp"
#include "engine/results/recognize_result.hpp"
#include "engine/scene/read_scene.hpp"
#include "storage/common/result.hpp"

namespace trivet {

/// One recognition of a study.
struct RecognitionCell {
  std::size_t library = 0;  ///< index of its file
  SceneInput scene;
  DegradeOptions degrade{};
  std::uint64_t degrade_seed = 0;
  RecognizeOptions options{};
};

/// What having a library open takes.
struct LibraryUse {
  double open_seconds = 0;       ///< until the first scene can begin
  std::uint64_t peak_bytes = 0;  ///< of the process' memory, since it was opened
};

/// Read, degrade and recognize scenes. Each cell runs on one thread, as many side by side as there
/// are threads, so that seconds are those of one core and no cell waits within itself. A library is
/// open from its first cell to its last: cells of one should stand together.
///
/// emit  gets each result as soon as it is there, in any order, one at a time, and what its library
///       took so far; its error ends the run
/// Errors: of opening, reading and recognizing; resumable when stopped.
Result<void> recognize_cells(std::span<const std::filesystem::path> libraries,
                             std::span<const RecognitionCell> cells, const Progress& progress,
                             const std::function<Result<void>(std::size_t cell, const SceneResult&,
                                                              const LibraryUse&)>& emit);

}  // namespace trivet

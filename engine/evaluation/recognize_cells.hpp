/// Recognition of many scenes with many libraries and options, for studies.
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
  std::size_t library = 0;  ///< index of the library's file
  SceneInput scene;
  DegradeOptions degrade{};
  std::uint64_t degrade_seed = 0;
  RecognizeOptions options{};
};

/// Cost of opening a library.
struct LibraryUse {
  double open_seconds = 0;       ///< time until the first scene can start
  std::uint64_t peak_bytes = 0;  ///< peak memory of the process since opening
};

/// Read, degrade and recognize scenes. Each cell runs on one thread, and cells run in parallel on
/// all threads, so that seconds are those of one core and no cell waits internally. A library is
/// open from its first cell to its last, so cells of one library should be adjacent.
///
/// emit  receives each result as soon as it is available, in any order, one at a time, with the
///       cost of its library so far; its error ends the run
/// Errors: those of opening, reading and recognizing; resumable when stopped.
Result<void> recognize_cells(std::span<const std::filesystem::path> libraries,
                             std::span<const RecognitionCell> cells, const Progress& progress,
                             const std::function<Result<void>(std::size_t cell, const SceneResult&,
                                                              const LibraryUse&)>& emit);

}  // namespace trivet

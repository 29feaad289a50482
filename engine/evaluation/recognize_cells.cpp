#include "engine/evaluation/recognize_cells.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "engine/recognition/recognize.hpp"
#include "storage/data/file_pose.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;

/// Reset the peak memory measurement of the process.
void reset_peak() { std::ofstream("/proc/self/clear_refs") << 5; }

std::uint64_t peak_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    std::uint64_t kilobytes = 0;
    if (word == "VmHWM:" && status >> kilobytes) return 1024 * kilobytes;
  }
  return 0;
}

/// A library with its features already indexed, so that no scene waits for that.
struct OpenLibrary {
  Recognizer recognizer;
  float mean_diameter = 0;
  double open_seconds = 0;

  explicit OpenLibrary(Library&& library) : recognizer(std::move(library)) {
    const std::span<const ModelInfo> models = recognizer.library().models;
    for (const ModelInfo& model : models)
      mean_diameter += model.diameter / static_cast<float>(models.size());
    (void)recognizer.features();
  }
};

/// The libraries that remaining cells need.
class Shelf {
 public:
  Shelf(std::span<const fs::path> files, std::span<const RecognitionCell> cells)
      : files_(files), open_(files.size()), num_left_(files.size()) {
    for (const RecognitionCell& cell : cells) ++num_left_[cell.library];
  }

  Result<std::shared_ptr<const OpenLibrary>> acquire(std::size_t index) {
    const std::lock_guard lock(mutex_);
    if (!open_[index]) {
      reset_peak();
      const auto begin = std::chrono::steady_clock::now();
      TRIVET_TRY_ASSIGN(Library library, trivet::open_library(files_[index]));
      const auto open = std::make_shared<OpenLibrary>(std::move(library));
      open->open_seconds =
          std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
      open_[index] = open;
    }
    return open_[index];
  }
  /// Release a library for one cell.
  void release(std::size_t index) {
    const std::lock_guard lock(mutex_);
    if (--num_left_[index] == 0) open_[index].reset();
  }

 private:
  std::span<const fs::path> files_;
  std::mutex mutex_;
  std::vector<std::shared_ptr<const OpenLibrary>> open_;
  std::vector<std::size_t> num_left_;
};

Result<SceneResult> recognize_cell(const OpenLibrary& library, const RecognitionCell& cell,
                                   const std::stop_token& stop) {
  TRIVET_TRY_ASSIGN(Cloud cloud, read_scene(cell.scene));
  if (cell.scene.viewpoint) cloud.viewpoint = in_cloud_frame(*cell.scene.viewpoint, cloud.offset);
  const float diameter = library.mean_diameter / static_cast<float>(cell.scene.scale);
  TRIVET_TRY(degrade_scene(cloud, cell.degrade, diameter, cell.degrade_seed));
  return recognize(library.recognizer, cloud, cell.scene, cell.options, stop);
}

}  // namespace

Result<void> recognize_cells(std::span<const fs::path> libraries,
                             std::span<const RecognitionCell> cells, const Progress& progress,
                             const std::function<Result<void>(std::size_t cell, const SceneResult&,
                                                              const LibraryUse&)>& emit) {
  Shelf shelf(libraries, cells);
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::optional<Error> failure;
  std::size_t num_done = 0;
  const auto fail = [&](const Error& error) {
    const std::lock_guard lock(mutex);
    if (!failure) failure = error;
    next = cells.size();
  };
  const auto work = [&] {
    for (std::size_t i = next++; i < cells.size() && !progress.stop.stop_requested(); i = next++) {
      const RecognitionCell& cell = cells[i];
      Result<std::shared_ptr<const OpenLibrary>> library = shelf.acquire(cell.library);
      if (!library) return fail(library.error());
      const Result<SceneResult> result = recognize_cell(**library, cell, progress.stop);
      if (!result) return fail(result.error());
      const LibraryUse use{(*library)->open_seconds, peak_bytes()};
      library->reset();
      shelf.release(cell.library);
      const std::lock_guard lock(mutex);
      if (const Result<void> kept = emit(i, *result, use); !kept) {
        failure = kept.error();
        next = cells.size();
        return;
      }
      progress(++num_done, cells.size(), cell.scene.file.filename().string());
    }
  };
  const int num_workers = tbb::this_task_arena::max_concurrency();
  tbb::parallel_for(
      tbb::blocked_range<int>(0, num_workers, 1),
      [&](const auto&) {
        tbb::task_arena alone(1);
        alone.execute(work);
      },
      tbb::simple_partitioner());

  if (failure) return *failure;
  if (num_done < cells.size()) {
    return Error{ErrorCode::resumable,
                 fmt::format("stopped after {} of {} scenes", num_done, cells.size())};
  }
  return {};
}

}  // namespace trivet

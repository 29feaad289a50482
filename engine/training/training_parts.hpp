/// Trained but unpublished models, stored on disk so that no run starts over.
///
/// The folder contains parts, which are libraries of some models without an index. For a library
/// that is written during training, it also contains the unfinished file and its tables of
/// contents.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "storage/common/result.hpp"
#include "storage/library/library.hpp"

namespace trivet::engine {

/// The folder beside a library during its training: LIBRARY.h5.parts.
std::filesystem::path parts_folder(const std::filesystem::path& library);
/// A free name in the folder for an unfinished library: N.models.
std::filesystem::path free_name(const std::filesystem::path& folder);
/// Name of the nth table of contents: N.models-n.
std::filesystem::path contents_of(const std::filesystem::path& unfinished, int n);

/// Open the parts of ended runs whose bytes are all intact. Other files with names of runs are
/// removed: they are from a process that died, or were not completely on disk when the power
/// failed. Pre: no process writes into the folder.
std::vector<Library> recover_parts(const std::filesystem::path& folder);

/// Open the parts of this run, including recovered ones.
std::vector<Library> open_parts(const std::filesystem::path& folder);

/// Close the parts and remove the folder after their models are published. Several files are
/// removed in parallel, since the kernel takes a while for gigabytes. Files that cannot be removed,
/// or whose names no run uses, remain.
void remove_parts(const std::filesystem::path& folder, std::vector<Library> parts) noexcept;

/// Decides when enough was written to be saved against the death of the process: after ten seconds
/// or 256 MB.
class KeepingTime {
 public:
  void add(const PackedModel& model);
  bool has_come() const;
  void reset() { *this = {}; }

 private:
  std::chrono::steady_clock::time_point since_ = std::chrono::steady_clock::now();
  std::uint64_t num_bytes_ = 0;
};

/// Writes models to parts as they arrive. A part becomes visible at intervals, so that a process
/// that dies loses only the models since then. Nothing waits for the disk: models lost in a power
/// failure are trained again.
class PartWriter {
 public:
  /// writer  distinguishes writers to one folder: rank 0, 1, ...
  PartWriter(std::filesystem::path folder, LibraryHeader header, TriSpinBasis basis, int writer)
      : folder_(std::move(folder)),
        header_(std::move(header)),
        basis_(std::move(basis)),
        writer_(writer) {}

  /// Errors: those of LibraryWriter.
  Result<void> add(PackedModel& model);
  /// Publish the models since the last part. Errors: those of LibraryWriter.
  Result<void> close();

 private:
  Result<void> open();

  std::filesystem::path folder_;
  LibraryHeader header_;
  TriSpinBasis basis_;
  int writer_;
  int num_parts_ = 0;
  std::optional<LibraryWriter> part_;
  KeepingTime time_;
};

}  // namespace trivet::engine

/// Models that are trained and not published yet, kept on disk so that no run starts over.
///
/// In the folder lie parts: libraries of some models without an index; and of a library that is
/// written while its models are trained the file as far as it is, with contents that tell of it.
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

/// The folder beside a library that is kept while it is trained: LIBRARY.h5.parts.
std::filesystem::path parts_folder(const std::filesystem::path& library);
/// A name in the folder for a library that is not finished: N.models.
std::filesystem::path free_name(const std::filesystem::path& folder);
/// Where its contents are told for the nth time: N.models-n.
std::filesystem::path contents_of(const std::filesystem::path& unfinished, int n);

/// What runs that have ended kept, all of whose bytes are as they were written. What else is named as
/// theirs is of a process that died, or was on its way to the disk when the power failed, and goes.
/// Pre: nobody writes into it.
std::vector<Library> recover_parts(const std::filesystem::path& folder);

/// What this run keeps, and what it recovered.
std::vector<Library> open_parts(const std::filesystem::path& folder);

/// Close the parts and remove the folder, once their models are published: several at a time, since
/// the kernel takes a while over gigabytes. What cannot be removed, or is named as no run names it,
/// stays.
void remove_parts(const std::filesystem::path& folder, std::vector<Library> parts) noexcept;

/// Says when so much was written that it must not be lost with its process: after ten seconds or
/// 256 MB.
class KeepingTime {
 public:
  void add(const PackedModel& model);
  bool has_come() const;
  void reset() { *this = {}; }

 private:
  std::chrono::steady_clock::time_point since_ = std::chrono::steady_clock::now();
  std::uint64_t num_bytes_ = 0;
};

/// Writes models as they come into parts, each of which appears when its time has come: a process that
/// dies loses no more. Nothing waits for the disk: what a power failure keeps from it is trained again.
class PartWriter {
 public:
  /// writer  tells those apart that write into one folder: rank 0, 1, ...
  PartWriter(std::filesystem::path folder, LibraryHeader header, TriSpinBasis basis, int writer)
      : folder_(std::move(folder)),
        header_(std::move(header)),
        basis_(std::move(basis)),
        writer_(writer) {}

  /// Errors: of LibraryWriter.
  Result<void> add(PackedModel& model);
  /// Publish what was added since the last part. Errors: of LibraryWriter.
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

/// About how many bytes a model takes in a file.
std::uint64_t stored_bytes(const Model& model);

}  // namespace trivet::engine

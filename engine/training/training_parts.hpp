/// Models that are trained and not published yet, kept on disk so that no run starts over.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "storage/library.hpp"
#include "storage/result.hpp"

namespace trivet::engine {

/// The folder beside a library that its parts lie in while it is trained: LIBRARY.h5.parts.
std::filesystem::path parts_folder(const std::filesystem::path& library);

/// The parts that are whole. What else lies in the folder is of a process that died, and goes.
/// Pre: nobody writes into it.
std::vector<Library> open_parts(const std::filesystem::path& folder);

/// Close the parts and remove them, once their models are published: several at a time, since the
/// kernel takes a while over gigabytes. What cannot be removed stays.
void remove_parts(const std::filesystem::path& folder, std::vector<Library> parts) noexcept;

/// Writes models as they come into files of the folder, each a library of some models without an
/// index. A part appears when it has lasted long enough: a process that dies loses no more.
class PartWriter {
 public:
  /// writer  tells those apart that write into one folder: rank 0, 1, ...
  PartWriter(std::filesystem::path folder, LibraryHeader header, TriSpinBasis basis, int writer)
      : folder_(std::move(folder)),
        header_(std::move(header)),
        basis_(std::move(basis)),
        writer_(writer) {}

  /// The model as it was written. Errors: of LibraryWriter.
  Result<std::shared_ptr<PackedModel>> add(const Model& model);
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
  std::chrono::steady_clock::time_point opened_;
  std::uint64_t num_bytes_ = 0;
};

/// About how many bytes a model takes in a file.
std::uint64_t stored_bytes(const Model& model);

}  // namespace trivet::engine

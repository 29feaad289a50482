/// Writer of a run's library during training.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "engine/training/training_parts.hpp"
#include "engine/training/training_run.hpp"
#include "storage/common/result.hpp"
#include "storage/library/library.hpp"

namespace trivet::engine {

/// Writes the first models of a library, by name, as they are trained. They arrive in any order,
/// since some take longer. This way they are written once, and writing leaves no processor idle.
/// The file is stored among the library's parts until it is finished. Its table of contents is
/// saved from time to time, so that its models survive the death of the process like those of
/// parts.
class IncrementalWriter {
 public:
  /// file     path of the library
  /// names    names of all its models
  /// sources  sources of its first models, rising: all of them are trained now
  IncrementalWriter(std::filesystem::path file, const LibraryHeader& header,
                    const TriSpinBasis& basis, const NamesToCome& names,
                    std::vector<std::size_t> sources)
      : file_(std::move(file)),
        header_(header),
        basis_(basis),
        names_(names),
        sources_(std::move(sources)) {}
  IncrementalWriter(const IncrementalWriter&) = delete;
  IncrementalWriter& operator=(const IncrementalWriter&) = delete;
  ~IncrementalWriter();

  /// Add a source's model. Returns models that the caller must store elsewhere, because they are
  /// not among the first or too many wait for a slower one before them. Errors: those of
  /// LibraryWriter.
  Result<PackedModels> add(std::size_t source, std::shared_ptr<PackedModel> model);
  /// End writing, since the library will be a different one. Written models remain like parts;
  /// waiting ones are returned. Errors: those of LibraryWriter.
  Result<PackedModels> give_up();

  std::size_t num_written() const noexcept { return num_written_; }
  /// Save the table of contents of everything written. Errors: those of LibraryWriter.
  Result<void> save_contents();
  /// The library with these models; absent if nothing was written. Pre: no more are added.
  std::optional<LibraryWriter> release() { return std::exchange(writer_, {}); }

 private:
  Result<void> begin();
  Result<void> write(PackedModel& model);
  PackedModels stop();

  std::filesystem::path file_;
  const LibraryHeader& header_;
  const TriSpinBasis& basis_;
  NamesToCome names_;
  std::vector<std::size_t> sources_;
  std::size_t next_ = 0;  // index into the sources
  std::map<std::size_t, std::shared_ptr<PackedModel>> waiting_;
  std::uint64_t bytes_waiting_ = 0;
  std::optional<LibraryWriter> writer_;
  std::filesystem::path unfinished_;
  KeepingTime time_;
  int num_saves_ = 0;            // number of saved tables of contents
  std::size_t num_unsaved_ = 0;  // number of models since then
  std::size_t num_written_ = 0;
};

}  // namespace trivet::engine

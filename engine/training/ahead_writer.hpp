/// The library of a run, written while its models are trained.
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

/// Writes the first models of a library, by name, as they are trained: in any order, since some take
/// longer. So they are written once, and writing leaves no processor idle. The file lies among the
/// library's parts until it is finished; its contents are told now and then, so that it is as good as
/// parts when the process dies.
class AheadWriter {
 public:
  /// file     of the library
  /// names    of all its models
  /// sources  whose models come first in it, rising: all of them are trained now
  AheadWriter(std::filesystem::path file, const LibraryHeader& header, const TriSpinBasis& basis,
              const NamesToCome& names, std::vector<std::size_t> sources)
      : file_(std::move(file)),
        header_(header),
        basis_(basis),
        names_(names),
        sources_(std::move(sources)) {}
  AheadWriter(const AheadWriter&) = delete;
  AheadWriter& operator=(const AheadWriter&) = delete;
  ~AheadWriter();

  /// A source's model. Gives back models that must be kept elsewhere: it is not among the first, or
  /// too many wait for a slower one before them. Errors: of LibraryWriter.
  Result<PackedModels> add(std::size_t source, std::shared_ptr<PackedModel> model);
  /// The library is going to be another one: what was written stays as parts are. Gives back those
  /// that waited. Errors: of LibraryWriter.
  Result<PackedModels> give_up();

  std::size_t num_written() const noexcept { return num_written_; }
  /// Tell the contents of what was written, all of it. Errors: of LibraryWriter.
  Result<void> tell();
  /// The library with those models; none: nothing was written. Pre: no more are added.
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
  std::size_t next_ = 0;  // of the sources
  std::map<std::size_t, std::shared_ptr<PackedModel>> waiting_;
  std::uint64_t bytes_waiting_ = 0;
  std::optional<LibraryWriter> writer_;
  std::filesystem::path unfinished_;
  KeepingTime time_;
  int num_told_ = 0;            // times
  std::size_t num_untold_ = 0;  // models
  std::size_t num_written_ = 0;
};

}  // namespace trivet::engine

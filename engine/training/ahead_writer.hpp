/// The library of a run, written while its models are trained.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "storage/file_lock.hpp"
#include "storage/library.hpp"
#include "storage/result.hpp"

namespace trivet::engine {

/// Writes the first models of a library, by name, as they are trained: in any order, since some take
/// longer. So they are not read again from where they are kept, and writing leaves no processor idle.
class AheadWriter {
 public:
  /// names    of all models of the library
  /// sources  whose models come first in it, rising: all of them are trained now
  AheadWriter(const LibraryHeader& header, const TriSpinBasis& basis, const FileLock& lock,
              const NamesToCome& names, std::vector<std::size_t> sources)
      : header_(header), basis_(basis), lock_(lock), names_(names), sources_(std::move(sources)) {}

  /// A source's model. Errors: of LibraryWriter.
  Result<void> add(std::size_t source, std::shared_ptr<PackedModel> model);
  /// The library is going to be another one: what was written goes.
  void give_up() noexcept;

  std::size_t num_written() const noexcept { return num_written_; }
  /// The library with those models; none: nothing was written. Pre: no more are added.
  std::optional<LibraryWriter> release();

 private:
  Result<void> write(PackedModel& model);

  const LibraryHeader& header_;
  const TriSpinBasis& basis_;
  const FileLock& lock_;
  NamesToCome names_;
  std::vector<std::size_t> sources_;
  std::size_t next_ = 0;  // of the sources
  std::map<std::size_t, std::shared_ptr<PackedModel>> waiting_;
  std::uint64_t bytes_waiting_ = 0;
  std::optional<LibraryWriter> writer_;
  std::size_t num_written_ = 0;
};

}  // namespace trivet::engine

/// Check state of an open file.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <span>
#include <string>
#include <vector>

#include "storage/files/file.hpp"
#include "storage/library/library.hpp"
#include "storage/library/model_record.hpp"

namespace trivet {

/// Location of a library's bytes. Released pages of a mapping are loaded from the file again.
enum class Held : std::uint8_t { mapped, in_memory };

/// Bytes of a file, relative to which offsets are given.
struct FileBytes {
  std::span<const std::byte> bytes;
  std::shared_ptr<const std::byte> owner;  ///< keeps the bytes alive
  MappedFile mapped{};  ///< mapping of the bytes, for as long as others may write the file
};

class LibraryChecks {
 public:
  LibraryChecks(std::filesystem::path file, FileBytes bytes, Held held,
                const std::vector<ModelRecord>& models, std::vector<LevelColumns> levels);

  /// Check a part of a model once: see Library::surface.
  Result<void> check(const std::string& name, const ModelColumns& columns, std::size_t index,
                     ModelPart part) const;
  /// See FeatureLevels::level.
  Result<void> check(const FeatureLevel& level, std::size_t index, std::size_t num_models) const;
  /// See Library::unchanged.
  Result<void> unchanged() const;
  bool is_changed() const noexcept {
    return file_bytes_.mapped.state() == MappedFile::State::changed;
  }
  /// See Library::ask_for.
  void ask_for(std::size_t index, ModelPart part) const noexcept;
  /// Release the pages of all bytes that are mapped.
  void release_memory() const noexcept;

 private:
  using StoredColumns = std::array<StoredColumn, format::kModelColumns.size()>;
  std::size_t state_of(std::size_t model, ModelPart part) const noexcept {
    return model * kModelParts.size() + static_cast<std::size_t>(part);
  }
  std::span<const std::byte> bytes_of(const StoredColumn& column) const noexcept {
    return file_bytes_.bytes.subspan(column.offset, column.bytes);
  }
  Result<void> check_bytes(const StoredColumn& column, const std::string& place) const;
  /// Whether all data that passed a check is still unchanged in the file.
  bool is_still_good() const;
  /// The checksum of a column's bytes, with little of it in memory at a time.
  Xxh3 checksum_of(std::span<const std::byte> bytes) const;

  std::filesystem::path file_;
  FileBytes file_bytes_;
  Held held_;
  std::vector<StoredColumns> models_;
  std::vector<LevelColumns> levels_;
  /// Whether a part passed its check; false if it failed or was not checked yet. Two threads may
  /// check the same part: both get the same result.
  mutable std::vector<std::atomic<bool>> good_parts_, good_levels_;
  mutable std::mutex touched_;  ///< held by the thread that repeats the checks
  /// Held by threads that check parts, and alone by one that drops the copies of what was checked.
  mutable std::shared_mutex copies_;
};

}  // namespace trivet

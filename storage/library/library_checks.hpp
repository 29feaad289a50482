/// What of an opened file has been checked.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "storage/files/file.hpp"
#include "storage/library/library.hpp"
#include "storage/library/model_record.hpp"

namespace trivet {

/// Where a library's bytes are: pages of a mapping come back from the file when they are given back.
enum class Held : std::uint8_t { mapped, in_memory };

/// Bytes of a file, in which offsets count.
struct FileBytes {
  std::span<const std::byte> bytes;
  std::shared_ptr<const std::byte> owner;  ///< keeps them alive
  MappedFile mapped{};                     ///< where they lie, for as long as others may write it
};

class LibraryChecks {
 public:
  LibraryChecks(std::filesystem::path file, FileBytes bytes, Held held,
                const std::vector<ModelRecord>& models, std::vector<LevelColumns> levels);

  /// As Library::check.
  Result<void> check(const Model& model, std::size_t index, ModelPart part) const;
  Result<void> check(const FeatureLevel& level, std::size_t index, std::size_t num_models) const;
  /// As Library::unchanged.
  Result<void> unchanged() const;
  bool is_changed() const noexcept {
    return file_bytes_.mapped.state() == MappedFile::State::changed;
  }
  /// As Library::ask_for.
  void ask_for(std::size_t index, ModelPart part) const noexcept;
  /// Let go of the pages of all bytes, where they are mapped.
  void give_back() const noexcept;

 private:
  using ModelColumns = std::array<StoredColumn, format::kModelColumns.size()>;
  std::size_t state_of(std::size_t model, ModelPart part) const noexcept {
    return model * kModelParts.size() + static_cast<std::size_t>(part);
  }
  std::span<const std::byte> bytes_of(const StoredColumn& column) const noexcept {
    return file_bytes_.bytes.subspan(column.offset, column.bytes);
  }
  Result<void> check_bytes(const StoredColumn& column, const std::string& place) const;
  bool has_checksum(const StoredColumn& column) const;
  /// Whether all that was found good still is.
  bool is_still_good() const;

  std::filesystem::path file_;
  FileBytes file_bytes_;
  Held held_;
  std::vector<ModelColumns> models_;
  std::vector<LevelColumns> levels_;
  /// Whether it is good; what is not has been found bad or not been looked at. Two threads may check
  /// the same: both find the same.
  mutable std::vector<std::atomic<bool>> good_parts_, good_levels_;
  mutable std::mutex touched_;  ///< held by the one that compares again
};

}  // namespace trivet

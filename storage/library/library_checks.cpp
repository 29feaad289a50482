#include "storage/library/library_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace trivet {
LibraryChecks::LibraryChecks(std::filesystem::path file, FileBytes bytes, Held held,
                             const std::vector<ModelRecord>& models,
                             std::vector<LevelColumns> levels)
    : file_(std::move(file)),
      file_bytes_(std::move(bytes)),
      held_(held),
      levels_(std::move(levels)),
      good_parts_(models.size() * kModelParts.size()),
      good_levels_(levels_.size()) {
  for (const ModelRecord& record : models) models_.push_back(record.columns);
}

Result<void> LibraryChecks::unchanged() const {
  using State = MappedFile::State;
  const MappedFile& mapped = file_bytes_.mapped;
  if (mapped.state() == State::same) return {};
  // Other threads wait meanwhile, as the bytes may have changed.
  const std::lock_guard lock(touched_);
  if (mapped.state() == State::touched) {
    const std::int64_t time = mapped.time_of_touch();
    if (is_still_good()) {
      mapped.accept_touch(time);
    } else {
      mapped.condemn();
    }
  }
  if (mapped.state() != State::changed) return {};
  return Error{
      ErrorCode::changed,
      fmt::format("{}: the library was changed in place after it was opened, so nothing is "
                  "answered from it; open or reload it, and replace a library in use by "
                  "renaming a complete one over it (mv, not cp)",
                  file_.string())};
}

bool LibraryChecks::is_still_good() const {
  const Result<MappedFile> now = file_bytes_.mapped.mapped_again();
  if (!now) return false;
  const auto is_good = [&](const StoredColumn& column) {
    return column == StoredColumn{} ||
           checksum_of(now->bytes().subspan(column.offset, column.bytes)) == column.checksum;
  };
  for (std::size_t m = 0; m < models_.size(); ++m) {
    for (std::size_t c = 0; c < format::kModelColumns.size(); ++c) {
      if (good_parts_[state_of(m, format::kModelColumns[c].part)] && !is_good(models_[m][c]))
        return false;
    }
  }
  for (std::size_t level = 0; level < levels_.size(); ++level) {
    if (good_levels_[level] && !std::ranges::all_of(levels_[level], is_good)) return false;
  }
  return true;
}

Xxh3 LibraryChecks::checksum_of(std::span<const std::byte> bytes) const {
  return held_ == Held::mapped ? xxh3_of_mapped(bytes) : xxh3(bytes);
}

Result<void> LibraryChecks::check_bytes(const StoredColumn& column,
                                        const std::string& place) const {
  const Xxh3 found = checksum_of(bytes_of(column));
  if (found == column.checksum) return {};
  TRIVET_TRY(unchanged());
  return Error{ErrorCode::damaged, fmt::format("{}: {}: {}", file_.string(), place,
                                               wrong_checksum(column.checksum, found))};
}

Result<void> LibraryChecks::check(const std::string& name, const ModelColumns& columns,
                                  std::size_t index, ModelPart part) const {
  std::atomic<bool>& good = good_parts_[state_of(index, part)];
  if (good.load(std::memory_order_acquire)) return {};
  const std::shared_lock lock(copies_);
  for (std::size_t c = 0; c < format::kModelColumns.size(); ++c) {
    const auto& [spec, of_part] = format::kModelColumns[c];
    const StoredColumn& column = models_[index][c];
    if (of_part != part || column == StoredColumn{}) continue;  // absent in older files
    const std::string place = fmt::format("/models/{}/{}{}{}", name, spec.group,
                                          spec.group.empty() ? "" : "/", spec.name);
    // What is computed with it must stay what it is, whoever writes to the file.
    TRIVET_TRY(file_bytes_.mapped.copy(bytes_of(column)));
    TRIVET_TRY(check_bytes(column, place));
  }
  if (const Result<void> checked = format::check_part(name, columns, part); !checked) {
    return Error{ErrorCode::damaged,
                 fmt::format("{}: {}", file_.string(), checked.error().message)};
  }
  good.store(true, std::memory_order_release);
  return {};
}

Result<void> LibraryChecks::check(const FeatureLevel& level, std::size_t index,
                                  std::size_t num_models) const {
  std::atomic<bool>& good = good_levels_[index];
  if (good.load(std::memory_order_acquire)) return {};
  const std::string path = fmt::format("/index/{:02}", index);
  for (std::size_t c = 0; c < kLevelColumns.size(); ++c) {
    const std::string place = fmt::format("{}/{}", path, kLevelColumns[c].name);
    TRIVET_TRY(check_bytes(levels_[index][c], place));
  }
  if (const Result<void> checked = format::check_level(level, num_models); !checked) {
    return Error{ErrorCode::damaged,
                 fmt::format("{}: {}/{}", file_.string(), path, checked.error().message)};
  }
  // A scene reads only a few of the lists.
  if (held_ == Held::mapped) {
    for (const StoredColumn& column : levels_[index]) release_pages(bytes_of(column));
  }
  good.store(true, std::memory_order_release);
  return {};
}

void LibraryChecks::ask_for(std::size_t index, ModelPart part) const noexcept {
  if (held_ != Held::mapped || good_parts_[state_of(index, part)].load(std::memory_order_relaxed))
    return;
  for (std::size_t c = 0; c < format::kModelColumns.size(); ++c) {
    if (format::kModelColumns[c].part == part) ask_for_pages(bytes_of(models_[index][c]));
  }
}

void LibraryChecks::release_memory() const noexcept {
  if (held_ != Held::mapped) return;
  release_pages(file_bytes_.bytes);
  // Copies of a file that was changed stay as long as scenes compute with them.
  const MappedFile& mapped = file_bytes_.mapped;
  if (!mapped.has_memory()) return;
  const std::unique_lock lock(copies_);
  if (mapped.state() != MappedFile::State::same) return;
  for (std::atomic<bool>& good : good_parts_) good = false;
  mapped.drop_copies();
}

}  // namespace trivet

#include "storage/library/library_checks.hpp"

#include <fmt/format.h>

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
  for (std::size_t m = 0; m < models_.size(); ++m) {
    for (std::size_t c = 0; c < format::kModelColumns.size(); ++c) {
      if (!good_parts_[state_of(m, format::kModelColumns[c].part)]) continue;
      if (models_[m][c] != StoredColumn{} && !has_checksum(models_[m][c])) return false;
    }
  }
  for (std::size_t level = 0; level < levels_.size(); ++level) {
    if (!good_levels_[level]) continue;
    for (const StoredColumn& column : levels_[level]) {
      if (!has_checksum(column)) return false;
      if (held_ == Held::mapped) release_pages(bytes_of(column));
    }
  }
  return true;
}

bool LibraryChecks::has_checksum(const StoredColumn& column) const {
  const auto bytes = bytes_of(column);
  return (held_ == Held::mapped ? xxh3_of_mapped(bytes) : xxh3(bytes)) == column.checksum;
}

Result<void> LibraryChecks::check_bytes(const StoredColumn& column,
                                        const std::string& place) const {
  const auto bytes = bytes_of(column);
  const Xxh3 found = held_ == Held::mapped ? xxh3_of_mapped(bytes) : xxh3(bytes);
  if (found == column.checksum) return {};
  TRIVET_TRY(unchanged());
  return Error{ErrorCode::bad_data, fmt::format("{}: {}: {}", file_.string(), place,
                                                wrong_checksum(column.checksum, found))};
}

Result<void> LibraryChecks::check(const std::string& name, const ModelColumns& columns,
                                  std::size_t index, ModelPart part) const {
  std::atomic<bool>& good = good_parts_[state_of(index, part)];
  if (good.load(std::memory_order_acquire)) return {};
  for (std::size_t c = 0; c < format::kModelColumns.size(); ++c) {
    const auto& [spec, of_part] = format::kModelColumns[c];
    const StoredColumn& column = models_[index][c];
    if (of_part != part || column == StoredColumn{}) continue;  // absent in older files
    const std::string place = fmt::format("/models/{}/{}{}{}", name, spec.group,
                                          spec.group.empty() ? "" : "/", spec.name);
    TRIVET_TRY(check_bytes(column, place));
  }
  if (const Result<void> checked = format::check_part(name, columns, part); !checked) {
    return Error{ErrorCode::bad_data,
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
    return Error{ErrorCode::bad_data,
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
  if (held_ == Held::mapped) release_pages(file_bytes_.bytes);
}

}  // namespace trivet

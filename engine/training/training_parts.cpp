#include "engine/training/training_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <regex>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "engine/common/parallel.hpp"
#include "storage/files/file.hpp"

namespace trivet::engine {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds kLongest{10};
constexpr std::uint64_t kMostBytes = std::uint64_t{256} << 20U;

fs::path part_of(const fs::path& folder, int writer, int number) {
  return folder / fmt::format("{}-{}.h5", writer, number);
}

constexpr std::string_view kPartEnd = ".h5", kUnfinishedEnd = ".models";

/// Whether a file has a name used by runs, including unfinished files: N-N.h5, N.models,
/// N.models-N.
bool is_of_run(const fs::path& file) {
  static const std::regex kName(R"(([0-9]+(-[0-9]+\.h5|\.models(-[0-9]+)?)|\.[0-9].*\.tmp))");
  return std::regex_match(file.filename().string(), kName);
}

/// The files of runs. Other files in the folder belong to others.
std::vector<fs::path> files_of(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (is_of_run(entry.path())) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

bool is_contents(const fs::path& file) {
  return file.extension().string().starts_with(fmt::format("{}-", kUnfinishedEnd));
}

Result<Library> open_part(const fs::path& file) {
  return is_contents(file) ? open_contents(file) : open_library(file, Writers::none);
}

}  // namespace

fs::path parts_folder(const fs::path& library) {
  fs::path folder = library;
  folder += ".parts";
  return folder;
}

fs::path free_name(const fs::path& folder) {
  fs::path file;
  std::error_code error;
  for (int n = 0; file.empty() || fs::exists(file, error); ++n)
    file = folder / fmt::format("{}{}", n, kUnfinishedEnd);
  return file;
}

fs::path contents_of(const fs::path& unfinished, int n) {
  return unfinished.parent_path() / fmt::format("{}-{}", unfinished.filename().string(), n);
}

std::vector<Library> recover_parts(const fs::path& folder) {
  std::set<fs::path> wanted;
  for (const fs::path& file : files_of(folder)) {
    const Result<Library> part = open_part(file);
    if (!part || !part->check_all()) continue;
    wanted.insert(file);
    if (is_contents(file)) wanted.insert(fs::path(file).replace_extension(kUnfinishedEnd));
  }
  for (const fs::path& file : files_of(folder)) {
    std::error_code error;
    if (!wanted.contains(file)) fs::remove(file, error);
  }
  return open_parts(folder);
}

std::vector<Library> open_parts(const fs::path& folder) {
  std::vector<Library> parts;
  for (const fs::path& file : files_of(folder)) {
    if (!is_contents(file) && file.extension() != kPartEnd) continue;
    if (Result<Library> part = open_part(file)) parts.push_back(std::move(*part));
  }
  return parts;
}

void remove_parts(const fs::path& folder, std::vector<Library> parts) noexcept {
  for_each_index(parts.size(), [&](std::size_t k) {
    std::error_code error;
    fs::remove(std::exchange(parts[k], {}).file, error);
  });
  std::error_code error;
  for (const fs::path& file : files_of(folder)) fs::remove(file, error);
  fs::remove(folder, error);
}

void KeepingTime::add(const PackedModel& model) { num_bytes_ += packed_bytes(model); }

bool KeepingTime::has_come() const {
  return num_bytes_ >= kMostBytes || std::chrono::steady_clock::now() - since_ >= kLongest;
}

Result<void> PartWriter::open() {
  TRIVET_TRY(make_folder(folder_));
  std::error_code error;
  while (fs::exists(part_of(folder_, writer_, num_parts_), error)) ++num_parts_;
  TRIVET_TRY_ASSIGN(LibraryWriter part,
                    LibraryWriter::create(part_of(folder_, writer_, num_parts_), header_));
  TRIVET_TRY(part.add(basis_));
  part_ = std::move(part);
  time_.reset();
  return {};
}

Result<void> PartWriter::add(PackedModel& model) {
  if (!part_) {
    TRIVET_TRY(open());
  }
  if (const Result<void> added = part_->add(model); !added) {
    part_.reset();
    return added;
  }
  time_.add(model);
  return time_.has_come() ? close() : Result<void>();
}

Result<void> PartWriter::close() {
  if (!part_) return {};
  const Result<void> published = part_->publish(Outlasts::process);
  part_.reset();
  if (published) release_cached_file(part_of(folder_, writer_, num_parts_));
  return published;
}

}  // namespace trivet::engine

#include "apps/service/own_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <span>
#include <vector>

#include "storage/files/file.hpp"

namespace trivet::apps::service {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxMarker = 4096;
constexpr std::string_view kLostAndFound = "lost+found";

/// Names in a folder, sorted.
std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
    names.push_back(at->path().filename().string());
  std::ranges::sort(names);
  return names;
}

/// A name that a folder without marker contains; empty: none.
std::string foreign_name(const fs::path& folder) {
  for (const std::string& name : names_in(folder)) {
    if (name != kLostAndFound) return name;
  }
  return "";
}

/// The text of the marker; none: not a regular file.
std::optional<std::string> marker_of(const fs::path& folder, const FolderKind& kind) {
  const fs::path file = folder / kind.marker;
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (descriptor < 0) return std::nullopt;
  const Result<std::vector<std::byte>> bytes = read_all(descriptor, file.string(), kMaxMarker);
  ::close(descriptor);
  if (!bytes) return std::nullopt;
  return std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size());
}

bool is_of_process(const std::string& name, const std::set<std::string>& files) {
  return std::ranges::any_of(
      files, [&](const std::string& file) { return name.starts_with(fmt::format(".{}.", file)); });
}

}  // namespace

FolderState folder_state(const fs::path& folder, const FolderKind& kind) {
  std::error_code error;
  const fs::file_status status = fs::symlink_status(folder, error);
  if (status.type() == fs::file_type::not_found) return FolderState::absent;
  if (!fs::is_directory(status)) return FolderState::foreign;
  if (note_of(folder, kind)) return FolderState::own;
  const bool is_readable = ::access(folder.c_str(), R_OK | X_OK) == 0;
  return is_readable && foreign_name(folder).empty() ? FolderState::empty : FolderState::foreign;
}

Result<void> check_own_folder(const fs::path& folder, const FolderKind& kind) {
  std::error_code error;
  const fs::path there = fs::weakly_canonical(folder, error);  // the option may name a link
  if (!error && folder_state(there, kind) != FolderState::foreign) return {};
  const std::optional<std::string> marker = marker_of(there, kind);
  const std::string found =
      !fs::is_directory(there, error) ? "a file"
      : marker                        ? fmt::format("{} that begins with '{}'", kind.marker,
                                                    marker->substr(0, std::min<std::size_t>(marker->find('\n'), 80)))
                                      : fmt::format("'{}' without it", foreign_name(there));
  return Error{ErrorCode::cannot_create,
               fmt::format("{0}: expected an empty folder or one that {1} has made, with the file "
                           "{2}, found {3}; name another folder, or, if an earlier version made "
                           "this one, mark it: echo {4} > {0}/{2}",
                           folder.string(), kind.option, kind.marker, found,
                           fmt::format("'{}'", kind.line))};
}

Result<void> claim_folder(const fs::path& folder, const FolderKind& kind) {
  TRIVET_TRY(check_own_folder(folder, kind));
  TRIVET_TRY(make_folder(folder));
  if (note_of(folder, kind)) return {};
  return mark_folder(folder, kind);
}

Result<void> mark_folder(const fs::path& folder, const FolderKind& kind, std::string_view note) {
  const std::string text = fmt::format("{}\n{}{}", kind.line, note, note.empty() ? "" : "\n");
  return publish_file(folder / kind.marker, std::as_bytes(std::span(text)));
}

std::optional<std::string> note_of(const fs::path& folder, const FolderKind& kind) {
  const std::optional<std::string> text = marker_of(folder, kind);
  const std::string line = fmt::format("{}\n", kind.line);
  if (!text || !text->starts_with(line)) return std::nullopt;
  return text->substr(line.size(), text->find('\n', line.size()) - line.size());
}

Result<void> check_below(const fs::path& folder, const fs::path& file) {
  fs::path at = folder;
  for (auto part = file.begin(); part != file.end(); ++part) {
    at /= *part;
    std::error_code error;
    const fs::file_status status = fs::symlink_status(at, error);
    if (status.type() == fs::file_type::not_found) return {};
    const bool is_last = std::next(part) == file.end();
    if (is_last ? fs::is_regular_file(status) : fs::is_directory(status)) continue;
    return Error{ErrorCode::cannot_create,
                 fmt::format("{}: expected {} or nothing at {}, found a link or something else; "
                             "move it away",
                             file.string(), is_last ? "a file" : "a folder",
                             at.lexically_relative(folder).string())};
  }
  return {};
}

void remove_own_folder(const fs::path& folder, const FolderKind& kind,
                       const std::set<std::string>& files) {
  const std::optional<std::string> note = note_of(folder, kind);
  if (folder_state(folder, kind) != FolderState::own) return;
  bool is_left = false;
  for (const std::string& name : names_in(folder)) {
    if (name == kind.marker) continue;
    const bool is_own = files.contains(name) || is_of_process(name, files);
    if (!is_own || ::unlink((folder / name).c_str()) != 0) is_left = true;
  }
  if (is_left) return;
  ::unlink((folder / kind.marker).c_str());
  // Files that a program has written there meanwhile belong to it, too.
  if (::rmdir(folder.c_str()) != 0) (void)mark_folder(folder, kind, note.value_or(""));
}

}  // namespace trivet::apps::service

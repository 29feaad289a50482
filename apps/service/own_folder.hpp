/// Folders that a service writes and cleans: those that a marker file says to be its own.
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "storage/common/result.hpp"

namespace trivet::apps::service {

/// What a service makes of a folder. The marker's first line is the kind with its version; what a
/// folder without one holds was made by somebody else.
struct FolderKind {
  std::string_view marker;  ///< name of the file
  std::string_view line;    ///< "trivet parts 1"
  std::string_view option;  ///< that names such a folder
};
inline constexpr FolderKind kPartsFolder{".trivet-parts", "trivet parts 1", "--allow-training"};
inline constexpr FolderKind kPartFolder{".trivet-part", "trivet part 1",
                                        ""};  ///< within the former
inline constexpr FolderKind kSessionFolder{".trivet-session", "trivet session 1", "--session"};

enum class FolderState : std::uint8_t {
  absent,
  empty,    ///< but for lost+found, which a file system of its own begins with
  own,      ///< it has the marker
  foreign,  ///< it holds something and has none, or is no folder, but perhaps a link to one
};
FolderState folder_state(const std::filesystem::path& folder, const FolderKind& kind);

/// Whether a folder that an option names is absent, empty or own. Errors: cannot_create (it is
/// foreign, and how one is made own).
Result<void> check_own_folder(const std::filesystem::path& folder, const FolderKind& kind);
/// The same, and mark what is absent or empty. Errors: cannot_create, io, too.
Result<void> claim_folder(const std::filesystem::path& folder, const FolderKind& kind);

/// Write the marker, with `note` as its second line.
Result<void> mark_folder(const std::filesystem::path& folder, const FolderKind& kind,
                         std::string_view note = "");
/// The note of a marker; none: there is no such marker.
std::optional<std::string> note_of(const std::filesystem::path& folder, const FolderKind& kind);

/// Whether a file may be written or removed: all folders between it and the own one are there as such
/// or not at all, and so is the file. Links lead elsewhere. Errors: cannot_create.
///
/// file  its path below `folder`
Result<void> check_below(const std::filesystem::path& folder, const std::filesystem::path& file);

/// Remove an own folder with these files and what programs put beside them while they write
/// (.FILE.…). What else lies there stays, and so does the folder then, with its marker. No link is
/// followed.
void remove_own_folder(const std::filesystem::path& folder, const FolderKind& kind,
                       const std::set<std::string>& files);

}  // namespace trivet::apps::service

/// Folders that a service writes and cleans. A marker file identifies them as belonging to the
/// service.
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "storage/common/result.hpp"

namespace trivet::apps::service {

/// A kind of folder of the service. The first line of the marker is the kind with its version. The
/// contents of a folder without a marker belong to somebody else.
struct FolderKind {
  std::string_view marker;  ///< name of the file
  std::string_view line;    ///< "trivet parts 1"
  std::string_view option;  ///< option that names such a folder
};
inline constexpr FolderKind kPartsFolder{".trivet-parts", "trivet parts 1", "--allow-training"};
inline constexpr FolderKind kPartFolder{".trivet-part", "trivet part 1",
                                        ""};  ///< within the former
inline constexpr FolderKind kSessionFolder{".trivet-session", "trivet session 1", "--session"};

enum class FolderState : std::uint8_t {
  absent,
  empty,    ///< except for lost+found, which a new file system contains
  own,      ///< has the marker
  foreign,  ///< not empty and without the marker, or no folder but perhaps a link to one
};
FolderState folder_state(const std::filesystem::path& folder, const FolderKind& kind);

/// Checks that the folder named by an option is absent, empty or marked.
/// Errors: cannot_create (it is foreign; the message explains how to mark it).
Result<void> check_own_folder(const std::filesystem::path& folder, const FolderKind& kind);
/// Checks the folder as above, and marks it if it is absent or empty. Errors: cannot_create, io,
/// too.
Result<void> claim_folder(const std::filesystem::path& folder, const FolderKind& kind);

/// Writes the marker, with `note` as its second line.
Result<void> mark_folder(const std::filesystem::path& folder, const FolderKind& kind,
                         std::string_view note = "");
/// The note of a marker; none: no such marker.
std::optional<std::string> note_of(const std::filesystem::path& folder, const FolderKind& kind);

/// Whether a file may be written or removed. All folders between it and the marked one must be
/// folders or absent, and the file must be a regular file or absent. Links lead elsewhere.
/// Errors: cannot_create.
///
/// file  path below `folder`
Result<void> check_below(const std::filesystem::path& folder, const std::filesystem::path& file);

/// Removes a marked folder with these files and the temporary files that programs write beside them
/// (.FILE.…). Other files stay, and then so does the folder with its marker. No link is followed.
void remove_own_folder(const std::filesystem::path& folder, const FolderKind& kind,
                       const std::set<std::string>& files);

}  // namespace trivet::apps::service

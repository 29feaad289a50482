/// Reads the folder of a session that an earlier service kept.
#pragma once

#include <filesystem>

#include "apps/service/serve/session/session_contents.hpp"

namespace trivet::apps::service {

/// Reads all of it. Damaged files are listed in `damaged` and stay as they are, except that damaged
/// listings are renamed. Files that a dying service was writing are removed.
SessionContents load_session(const std::filesystem::path& folder);

}  // namespace trivet::apps::service

/// What lies in the folder of a session that an earlier service kept.
#pragma once

#include <filesystem>

#include "apps/service/serve/session/session_contents.hpp"

namespace trivet::apps::service {

/// Read all of it. What is damaged is listed in `damaged` and stays as it is, but damaged listings
/// are renamed. Files that a dying service was writing are removed.
SessionContents load_session(const std::filesystem::path& folder);

}  // namespace trivet::apps::service

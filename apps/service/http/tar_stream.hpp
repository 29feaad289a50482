/// An archive of files, streamed piece by piece.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/service/http/http_server.hpp"

namespace trivet::apps::service {

struct TarEntry {
  std::string name;  ///< up to 155 bytes of folders, a slash, and up to 100 bytes of file name
  std::filesystem::path file;
  std::uint64_t bytes = 0;
};

/// An uncompressed archive of regular files (POSIX ustar). A file that is missing or whose size has
/// changed ends it early.
HttpStream tar_stream(std::vector<TarEntry> entries);

}  // namespace trivet::apps::service

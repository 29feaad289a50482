/// Files as one archive, told piece by piece.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/service/http/http_server.hpp"

namespace trivet::apps::service {

struct TarEntry {
  std::string name;  ///< at most 155 bytes of folders, a slash, and at most 100 of the file's name
  std::filesystem::path file;
  std::uint64_t bytes = 0;
};

/// An uncompressed archive of regular files (POSIX ustar). A file that is no longer there, or of
/// another size, ends it early.
HttpStream tar_stream(std::vector<TarEntry> entries);

}  // namespace trivet::apps::service

/// Files as bodies, read while they are sent.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>

#include "apps/service/http/http_messages.hpp"
#include "apps/service/http/http_server.hpp"

namespace trivet::apps::service {

/// Reads one file to its end, of which the size is known.
class FileReader {
 public:
  FileReader() = default;
  FileReader(const std::filesystem::path& file, std::uint64_t bytes)
      : stream_(file, std::ios::binary), left_(bytes) {}
  std::uint64_t left() const { return left_; }
  /// At most as much as is left; 0: it cannot be read.
  std::size_t read(std::span<char> out);

 private:
  std::ifstream stream_;
  std::uint64_t left_ = 0;
};

/// The whole file, as it is now; ends early if it becomes shorter. 404 where there is none.
HttpResponse file_response(const std::filesystem::path& file,
                           const std::string& content_type = kBytes);

}  // namespace trivet::apps::service

#include "apps/service/common/file_reader.hpp"

#include <algorithm>
#include <system_error>

namespace trivet::apps::service {

std::optional<FileReader> FileReader::open(const std::filesystem::path& file) {
  std::error_code error;
  const std::uint64_t bytes = std::filesystem::file_size(file, error);
  if (error) return std::nullopt;
  return FileReader(file, bytes);
}

std::size_t FileReader::read(std::span<char> out) {
  const std::uint64_t n = std::min<std::uint64_t>(out.size(), left_);
  stream_.read(out.data(), static_cast<std::streamsize>(n));
  const auto got = static_cast<std::size_t>(stream_.gcount());
  left_ -= got;
  return got;
}

}  // namespace trivet::apps::service

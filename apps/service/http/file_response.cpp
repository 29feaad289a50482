#include "apps/service/http/file_response.hpp"

#include <algorithm>
#include <memory>
#include <system_error>

namespace trivet::apps::service {

std::size_t FileReader::read(std::span<char> out) {
  const std::uint64_t n = std::min<std::uint64_t>(out.size(), left_);
  stream_.read(out.data(), static_cast<std::streamsize>(n));
  const auto got = static_cast<std::size_t>(stream_.gcount());
  left_ -= got;
  return got;
}

HttpResponse file_response(const std::filesystem::path& file, const std::string& content_type) {
  std::error_code error;
  const std::uint64_t bytes = std::filesystem::file_size(file, error);
  if (error) return error_response(404, "the file is gone");
  HttpResponse response{200, {}, content_type, {}};
  response.stream = {bytes,
                     [reader = std::make_shared<FileReader>(file, bytes)](std::span<char> out) {
                       while (!out.empty()) {
                         const std::size_t n = reader->read(out);
                         if (n == 0) return false;
                         out = out.subspan(n);
                       }
                       return true;
                     }};
  return response;
}

}  // namespace trivet::apps::service

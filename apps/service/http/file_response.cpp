#include "apps/service/http/file_response.hpp"

#include <memory>
#include <span>
#include <utility>

namespace trivet::apps::service {

HttpResponse file_response(std::optional<FileReader> file, const std::string& content_type) {
  if (!file) return error_response(404, "the file is gone");
  HttpResponse response{200, {}, content_type, {}};
  const std::uint64_t num_bytes = file->left();
  response.stream = {
      num_bytes, [reader = std::make_shared<FileReader>(*std::move(file))](std::span<char> out) {
        while (!out.empty()) {
          const std::size_t n = reader->read(out);
          if (n == 0) return false;
          out = out.subspan(n);
        }
        return true;
      }};
  return response;
}

HttpResponse file_response(const std::filesystem::path& file, const std::string& content_type) {
  return file_response(FileReader::open(file), content_type);
}

}  // namespace trivet::apps::service

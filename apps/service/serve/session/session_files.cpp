#include "apps/service/serve/session/session_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

#include "storage/library/model_name.hpp"

namespace trivet::apps::service {

bool is_session_name(std::string_view name) noexcept {
  const auto is_ascii = [](char c) { return static_cast<unsigned char>(c) < 0x80; };
  return name.size() <= kMaxSessionNameSize && std::ranges::all_of(name, is_ascii) &&
         is_model_name(name);
}

std::string mesh_file(const std::string& model) { return fmt::format("models/{}.ply", model); }

std::string answer_file(const std::string& run, const std::string& scan) {
  return fmt::format("runs/{}/{}.json", run, scan);
}

std::optional<std::uint64_t> regular_file_bytes(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(std::filesystem::symlink_status(file, error)))
    return std::nullopt;
  const std::uint64_t bytes = std::filesystem::file_size(file, error);
  return error ? std::nullopt : std::optional(bytes);
}

}  // namespace trivet::apps::service

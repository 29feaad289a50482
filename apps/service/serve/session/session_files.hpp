/// The files of a session's folder, named by their paths below it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace trivet::apps::service {

inline constexpr const char* kScansFile = "scans.json";
inline constexpr const char* kManifestFile = "manifest.json";
inline constexpr std::size_t kMaxSessionNameSize = 64;

/// Whether a name in requests to a session is valid: [A-Za-z0-9][A-Za-z0-9._-]{0,63} without "..".
bool is_session_name(std::string_view name) noexcept;

std::string mesh_file(const std::string& model);
std::string answer_file(const std::string& run, const std::string& scan);

/// The size of a file; none: not a regular file.
std::optional<std::uint64_t> regular_file_bytes(const std::filesystem::path& file);

}  // namespace trivet::apps::service

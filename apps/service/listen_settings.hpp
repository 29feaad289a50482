/// Settings of all programs that listen for HTTP.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "apps/service/http/http_server.hpp"
#include "apps/service/settings_file.hpp"

namespace trivet::apps::service {

struct ListenSettings {
  std::string address = "127.0.0.1", log = "info", token_file;
  std::vector<std::string> host_names;  ///< as returned by parse_host_name
  std::uint16_t port = 8080;
  std::uint32_t max_body_mb = 64, max_connections = 1024, max_connections_per_address = 512;
  std::uint32_t request_timeout_ms = 10'000, idle_timeout_ms = 60'000;
  std::uint32_t deadline_ms = 10'000, drain_grace_ms = 2000, exit_timeout_ms = 30'000;

  /// max_arriving_mb  bodies that are being received, in total
  HttpLimits http(std::uint32_t max_arriving_mb) const;
  /// The file descriptor that a log is written to.
  int log_descriptor() const;
};

/// The upper limit of all memory bounds.
inline constexpr std::uint32_t kMaxMb = 1 << 20;

/// The settings write to `settings`, which outlives them.
std::vector<Setting> settings_of(ListenSettings& settings);

/// Contradictions between settings. `bound` names the setting of `max_arriving_mb`.
SettingFaults faults_of(const ListenSettings& settings, std::string_view bound,
                        std::uint32_t max_arriving_mb);

}  // namespace trivet::apps::service

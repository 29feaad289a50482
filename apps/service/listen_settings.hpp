/// What all that listen for HTTP can be told.
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
  std::vector<std::string> host_names;  ///< as parse_host_name gives them
  std::uint16_t port = 8080;
  std::uint32_t max_body_mb = 64, max_connections = 1024, max_connections_per_address = 512;
  std::uint32_t request_timeout_ms = 10'000, idle_timeout_ms = 60'000;
  std::uint32_t deadline_ms = 10'000, drain_grace_ms = 2000, exit_timeout_ms = 30'000;

  /// max_arriving_mb  of bodies on their way, all together
  HttpLimits http(std::uint32_t max_arriving_mb) const;
  /// Where a log goes.
  int log_descriptor() const;
};

/// The most that any bound on memory may be.
inline constexpr std::uint32_t kMaxMb = 1 << 20;

/// They write to `settings`, which outlives them.
std::vector<Setting> settings_of(ListenSettings& settings);

/// What contradicts itself. `bound` names the setting of `max_arriving_mb`.
SettingFaults faults_of(const ListenSettings& settings, std::string_view bound,
                        std::uint32_t max_arriving_mb);

}  // namespace trivet::apps::service

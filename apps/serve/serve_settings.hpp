/// Everything that a service can be told, by flags or in a file.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>

#include "apps/http/http_server.hpp"
#include "engine/recognition_service.hpp"
#include "storage/result.hpp"

namespace trivet::apps {

struct ServeSettings {
  std::string library, examples, address = "127.0.0.1", log = "info";
  std::uint16_t port = 8080;
  std::uint32_t parallel = 0, max_waiting = 64, max_waiting_mb = 512, max_body_mb = 64;
  std::uint32_t max_connections = 1024, max_connections_per_address = 512;
  std::uint32_t request_timeout_ms = 10'000, idle_timeout_ms = 60'000;
  std::uint32_t deadline_ms = 10'000, drain_grace_ms = 2000, exit_timeout_ms = 30'000;

  ServiceOptions service() const;
  HttpLimits http() const;
};

struct ServeSetting {
  std::string_view name, meaning;
  std::function<std::string(const ServeSettings&)> text;
  /// Errors: usage (what was expected, and the value).
  std::function<Result<void>(ServeSettings&, const std::string& value)> set;
};

/// The flags without their dashes are the keys of the file.
std::span<const ServeSetting> serve_settings();

/// The settings of a TOML file, if one is named, with those of flags in their place.
/// flags  values by name; all names are settings
/// Errors: missing_input, usage: everything that is wrong, a line each, also of what contradicts
/// itself.
Result<ServeSettings> read_serve_settings(const std::string& file,
                                          const std::map<std::string, std::string>& flags);

}  // namespace trivet::apps

#include "apps/service/listen_settings.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstddef>
#include <utility>

#include "apps/service/http/access.hpp"

namespace trivet::apps::service {
namespace {

constexpr std::uint32_t kHourMs = 3'600'000;

Setting log_setting(std::string& value) {
  Setting setting = text_setting("log",
                                 "To standard error, a JSON object a line: info, every recognition "
                                 "and what failed; none",
                                 value);
  setting.set = [&value](const std::string& text) -> Result<void> {
    if (text != "info" && text != "none")
      return Error{ErrorCode::usage, fmt::format("log: expected info or none, found '{}'", text)};
    value = text;
    return {};
  };
  return setting;
}

Setting host_name_setting(std::vector<std::string>& names) {
  return {"host-name",
          "Name or address that clients and proxies know the service by, beside localhost and the "
          "address that they connect to; may be given again; other Host headers get 421",
          "",
          [&names](const std::string& text) -> Result<void> {
            Result<std::string> name = parse_host_name(text);
            if (!name) return name.error();
            names.push_back(*std::move(name));
            return {};
          },
          "",
          true};
}

}  // namespace

HttpLimits ListenSettings::http(std::uint32_t max_arriving_mb) const {
  HttpLimits limits;
  limits.max_body_bytes = std::size_t{max_body_mb} << 20;
  limits.max_arriving_bytes = std::size_t{max_arriving_mb} << 20;
  limits.max_connections = max_connections;
  limits.max_connections_per_address = max_connections_per_address;
  limits.request_timeout = std::chrono::milliseconds(request_timeout_ms);
  limits.idle_timeout = std::chrono::milliseconds(idle_timeout_ms);
  return limits;
}

int ListenSettings::log_descriptor() const { return log == "none" ? -1 : STDERR_FILENO; }

std::vector<Setting> settings_of(ListenSettings& settings) {
  ListenSettings& s = settings;
  return {
      text_setting("address", "To listen on", s.address),
      number_setting("port", "To listen on; 0: any free one", s.port, 0, 65'535),
      host_name_setting(s.host_names),
      text_setting(
          "token-file",
          "Ask for one of the bearer tokens of this file, one a line; others get 401; read "
          "again at SIGHUP",
          s.token_file),
      number_setting("max-body-mb", "Larger bodies get 413", s.max_body_mb, 1, kMaxMb),
      number_setting("max-connections", "Open at a time; more wait", s.max_connections, 1, 100'000),
      number_setting("max-connections-per-address", "Of one client; more get 503",
                     s.max_connections_per_address, 1, 100'000),
      number_setting("request-timeout-ms", "For a request to arrive; then 408",
                     s.request_timeout_ms, 1, kHourMs),
      number_setting("idle-timeout-ms", "For a connection between requests; then it is closed",
                     s.idle_timeout_ms, 1, kHourMs),
      number_setting("deadline-ms", "For an answer, where a request has no X-Deadline-Ms; then 504",
                     s.deadline_ms, 1, kHourMs),
      number_setting("drain-grace-ms", "Between not being ready and taking no more",
                     s.drain_grace_ms, 0, kHourMs),
      number_setting("exit-timeout-ms", "For what came in, after SIGTERM", s.exit_timeout_ms, 0,
                     kHourMs),
      log_setting(s.log),
  };
}

SettingFaults faults_of(const ListenSettings& settings, std::string_view bound,
                        std::uint32_t max_arriving_mb) {
  const ListenSettings& s = settings;
  SettingFaults faults;
  if (const Result<void> good = check_address(s.address, s.port); !good)
    faults.push_back(good.error().message);
  if (!s.token_file.empty()) {
    if (const Result<TokenFile> file = read_token_file(s.token_file); !file)
      faults.push_back(fmt::format("token-file: {}", file.error().message));
  }
  if (s.max_body_mb > max_arriving_mb) {
    faults.push_back(
        fmt::format("max-body-mb: expected at most {}, {}, found {}: no request that large could "
                    "be taken",
                    bound, max_arriving_mb, s.max_body_mb));
  }
  if (s.max_connections_per_address > s.max_connections) {
    faults.push_back(
        fmt::format("max-connections-per-address: expected at most max-connections, {}, found {}",
                    s.max_connections, s.max_connections_per_address));
  }
  return faults;
}

}  // namespace trivet::apps::service

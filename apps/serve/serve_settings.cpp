#include "apps/serve/serve_settings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <limits>
#include <optional>
#include <vector>

#include "storage/file.hpp"

namespace trivet::apps {
namespace {

constexpr std::uint64_t kMaxFileBytes = 1 << 20;
constexpr std::uint32_t kHourMs = 3'600'000, kMaxMb = 1 << 20;

template <class Number>
ServeSetting number(std::string_view name, std::string_view meaning, Number ServeSettings::*member,
                    Number low, Number high) {
  return {name, meaning,
          [member](const ServeSettings& settings) { return std::to_string(settings.*member); },
          [=](ServeSettings& settings, const std::string& text) -> Result<void> {
            Number value = 0;
            const char* const end = text.data() + text.size();
            const auto read = std::from_chars(text.data(), end, value);
            if (read.ec != std::errc() || read.ptr != end || value < low || value > high) {
              return Error{ErrorCode::usage,
                           fmt::format("{}: expected a whole number from {} to {}, found '{}'",
                                       name, low, high, text)};
            }
            settings.*member = value;
            return {};
          }};
}

ServeSetting text(std::string_view name, std::string_view meaning,
                  std::string ServeSettings::*member) {
  return {name, meaning, [member](const ServeSettings& settings) { return settings.*member; },
          [member](ServeSettings& settings, const std::string& value) -> Result<void> {
            settings.*member = value;
            return {};
          }};
}

ServeSetting log_level() {
  ServeSetting setting =
      text("log",
           "To standard error, a JSON object a line: info, every recognition and what failed; "
           "none",
           &ServeSettings::log);
  setting.set = [](ServeSettings& settings, const std::string& value) -> Result<void> {
    if (value != "info" && value != "none") {
      return Error{ErrorCode::usage, fmt::format("log: expected info or none, found '{}'", value)};
    }
    settings.log = value;
    return {};
  };
  return setting;
}

class SettingsReader {
 public:
  void set(const std::string& where, const std::string& name, const std::string& value) {
    const auto settings = serve_settings();
    const auto found = std::ranges::find(settings, name, &ServeSetting::name);
    if (found == settings.end()) {
      std::vector<std::string_view> names;
      for (const ServeSetting& setting : settings) names.push_back(setting.name);
      return fault(where,
                   fmt::format("expected one of {}, found '{}'", fmt::join(names, ", "), name));
    }
    if (const Result<void> done = found->set(settings_, value); !done)
      fault(where, done.error().message);
  }

  Result<void> read(const std::string& file, const std::map<std::string, std::string>& flags) {
    const Result<MappedFile> bytes = MappedFile::open(file, kMaxFileBytes);
    if (!bytes) return bytes.error();
    const std::string_view text(reinterpret_cast<const char*>(bytes->bytes().data()),
                                bytes->bytes().size());
    const std::string name = std::filesystem::path(file).filename().string();
    try {
      for (const auto& [key, node] : toml::parse(text)) {
        const std::string where = fmt::format("{}:{}: ", name, node.source().begin.line);
        const std::string setting(key.str());
        if (const auto number = node.value_exact<std::int64_t>()) {
          if (!flags.contains(setting)) set(where, setting, std::to_string(*number));
        } else if (const auto value = node.value_exact<std::string>()) {
          if (!flags.contains(setting)) set(where, setting, *value);
        } else {
          fault(where, setting + ": expected a whole number or a text");
        }
      }
    } catch (const toml::parse_error& error) {
      fault(fmt::format("{}:{}: ", name, error.source().begin.line),
            std::string(error.description()));
    }
    return {};
  }

  void check() {
    const ServeSettings& s = settings_;
    if (s.library.empty()) {
      fault("", "library: expected a file made by `trivet train`, found none");
    } else {
      check_file("library", s.library);
    }
    if (!s.examples.empty()) check_file("examples", s.examples);
    if (s.max_body_mb > s.max_waiting_mb) {
      fault("", fmt::format("max-body-mb: expected at most max-waiting-mb, {}, found {}: no "
                            "request that large could be taken",
                            s.max_waiting_mb, s.max_body_mb));
    }
    if (s.max_connections_per_address > s.max_connections) {
      fault("", fmt::format("max-connections-per-address: expected at most max-connections, {}, "
                            "found {}",
                            s.max_connections, s.max_connections_per_address));
    }
  }

  Result<ServeSettings> result() {
    if (faults_.empty()) return std::move(settings_);
    return Error{ErrorCode::usage, fmt::format("{}", fmt::join(faults_, "\nerror: "))};
  }

 private:
  void fault(const std::string& where, const std::string& what) { faults_.push_back(where + what); }
  void check_file(std::string_view setting, const std::string& file) {
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored))
      fault("", fmt::format("{}: {}: no such file", setting, file));
  }

  ServeSettings settings_;
  std::vector<std::string> faults_;
};

}  // namespace

ServiceOptions ServeSettings::service() const {
  return {max_waiting, std::size_t{max_waiting_mb} << 20, parallel};
}

HttpLimits ServeSettings::http() const {
  HttpLimits limits;
  limits.max_body_bytes = std::size_t{max_body_mb} << 20;
  limits.max_arriving_bytes = std::size_t{max_waiting_mb} << 20;
  limits.max_connections = max_connections;
  limits.max_connections_per_address = max_connections_per_address;
  limits.request_timeout = std::chrono::milliseconds(request_timeout_ms);
  limits.idle_timeout = std::chrono::milliseconds(idle_timeout_ms);
  return limits;
}

std::span<const ServeSetting> serve_settings() {
  using S = ServeSettings;
  static const std::vector<ServeSetting> settings{
      text("library", "Library file, made by `trivet train`", &S::library),
      text("address", "To listen on", &S::address),
      number<std::uint16_t>("port", "To listen on; 0: any free one", &S::port, 0, 65'535),
      number("parallel",
             "Scenes at a time: 1 for the shortest answer of each, 0, one a core, for the most "
             "answers",
             &S::parallel, 0U, 1024U),
      number("max-waiting", "Scenes that may wait; more get 503", &S::max_waiting, 1U, 100'000U),
      number("max-waiting-mb", "Memory of requests that arrive, wait and run; more get 503",
             &S::max_waiting_mb, 1U, kMaxMb),
      number("max-body-mb", "Larger bodies get 413", &S::max_body_mb, 1U, kMaxMb),
      number("max-connections", "Open at a time; more wait", &S::max_connections, 1U, 100'000U),
      number("max-connections-per-address", "Of one client; more get 503",
             &S::max_connections_per_address, 1U, 100'000U),
      number("request-timeout-ms", "For a request to arrive; then 408", &S::request_timeout_ms, 1U,
             kHourMs),
      number("idle-timeout-ms", "For a connection between requests; then it is closed",
             &S::idle_timeout_ms, 1U, kHourMs),
      number("deadline-ms", "For an answer, where a request has no X-Deadline-Ms; then 504",
             &S::deadline_ms, 1U, kHourMs),
      number("drain-grace-ms", "Between not being ready and taking no more", &S::drain_grace_ms, 0U,
             kHourMs),
      number("exit-timeout-ms", "For what came in, after SIGTERM", &S::exit_timeout_ms, 0U,
             kHourMs),
      text("examples", "Manifest or BOP data set whose scenes the page offers", &S::examples),
      log_level(),
  };
  return settings;
}

Result<ServeSettings> read_serve_settings(const std::string& file,
                                          const std::map<std::string, std::string>& flags) {
  SettingsReader reader;
  if (!file.empty()) {
    if (const Result<void> done = reader.read(file, flags); !done) return done.error();
  }
  for (const auto& [name, value] : flags) reader.set(name == "library" ? "" : "--", name, value);
  reader.check();
  return reader.result();
}

}  // namespace trivet::apps

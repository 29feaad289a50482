#include "apps/service/route/route_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

namespace trivet::apps::service {
namespace {

Setting shards_setting(std::vector<ShardAddress>& shards) {
  return {"shards",
          "host:port of each `trivet serve`, by address or name",
          "",
          [&shards](const std::string& text) -> Result<void> {
            Result<ShardAddress> shard = parse_shard(text);
            if (!shard) return shard.error();
            if (std::ranges::count(shards, text, &ShardAddress::name) > 0) {
              return Error{ErrorCode::usage,
                           fmt::format("shards: expected each once, found '{}' twice", text)};
            }
            shards.push_back(std::move(*shard));
            return {};
          },
          "SHARD",
          true};
}

}  // namespace

RouterOptions RouteSettings::router() const {
  return {std::chrono::milliseconds(listen.deadline_ms), max_inflight,
          std::size_t{max_inflight_mb} << 20};
}

std::vector<Setting> settings_of(RouteSettings& settings) {
  RouteSettings& s = settings;
  std::vector<Setting> all{
      shards_setting(s.shards),
      number_setting("max-inflight", "Recognitions at a time; more get 503", s.max_inflight, 1,
                     100'000),
      number_setting("max-inflight-mb", "Memory of their bodies; more get 503", s.max_inflight_mb,
                     1, kMaxMb),
  };
  for (Setting& one : settings_of(s.listen)) all.push_back(std::move(one));
  return all;
}

SettingFaults faults_of(const RouteSettings& settings) {
  SettingFaults faults = faults_of(settings.listen, "max-inflight-mb", settings.max_inflight_mb);
  if (settings.shards.empty())
    faults.emplace_back("shards: expected host:port of each `trivet serve`, found none");
  return faults;
}

}  // namespace trivet::apps::service

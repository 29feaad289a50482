/// Everything that a router can be told.
#pragma once

#include <cstdint>
#include <vector>

#include "apps/service/listen_settings.hpp"
#include "apps/service/route/router.hpp"

namespace trivet::apps::service {

struct RouteSettings {
  std::vector<ShardAddress> shards;
  std::uint32_t max_inflight = 256, max_inflight_mb = 512;
  ListenSettings listen;

  RouterOptions router() const;
};

/// They write to `settings`, which outlives them.
std::vector<Setting> settings_of(RouteSettings& settings);

/// What is missing or contradicts itself.
SettingFaults faults_of(const RouteSettings& settings);

}  // namespace trivet::apps::service

/// What systemd is told of a service that it has started with Type=notify.
///
/// Source: sd_notify(3): lines NAME=VALUE in one datagram to the socket that NOTIFY_SOCKET names.
#pragma once

#include <chrono>
#include <optional>
#include <string_view>

namespace trivet::apps::service {

/// Tell a state, as READY=1, RELOADING=1, STOPPING=1 or WATCHDOG=1. Does nothing where nobody asks.
void notify_systemd(std::string_view state);

/// How often at least WATCHDOG=1 is to be told; none: nobody waits for it.
std::optional<std::chrono::microseconds> watchdog_interval();

}  // namespace trivet::apps::service

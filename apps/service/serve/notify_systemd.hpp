/// Notifications to systemd from a service started with Type=notify.
///
/// Source: sd_notify(3): lines NAME=VALUE in one datagram to the socket that NOTIFY_SOCKET names.
#pragma once

#include <chrono>
#include <optional>
#include <string_view>

namespace trivet::apps::service {

/// Sends a state: READY=1, RELOADING=1, STOPPING=1 or WATCHDOG=1. Does nothing without a
/// NOTIFY_SOCKET.
void notify_systemd(std::string_view state);

/// The longest interval between WATCHDOG=1 notifications; none: there is no watchdog.
std::optional<std::chrono::microseconds> watchdog_interval();

}  // namespace trivet::apps::service

/// The life cycle of a program that serves HTTP until it is stopped.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "apps/service/common/request_log.hpp"
#include "apps/service/http/access.hpp"
#include "apps/service/http/bearer_tokens.hpp"
#include "apps/service/http/http_server.hpp"
#include "apps/service/listen_settings.hpp"
#include "storage/common/result.hpp"

namespace trivet::apps::service {

/// Starts, waits, drains and ends. Construct it before everything that sends responses or writes to
/// its log.
class Daemon {
 public:
  using Clock = std::chrono::steady_clock;

  /// max_arriving_mb  bodies that are being received, in total
  Daemon(const ListenSettings& settings, std::uint32_t max_arriving_mb)
      : settings_(settings),
        max_arriving_mb_(max_arriving_mb),
        log_(settings.log_descriptor()),
        access_(settings.host_names, settings.token_file.empty() ? nullptr : &tokens_) {}
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;

  RequestLog& log() { return log_; }
  /// Reads the token file, if there is one. If that fails, the old tokens stay.
  /// Errors: those of read_token_file.
  Result<void> read_tokens();
  std::size_t num_connections() const;  ///< open connections; from any thread

  /// Listens, and answers admitted requests by `routes.handle` and `routes.admit`, on the network
  /// thread. Access decides which are admitted; `routes.is_free` selects those that need no token,
  /// and `routes.count_refused` counts the others.
  /// Errors: usage (address), cannot_create (the port is in use).
  template <class Routes>
  Result<void> start(Routes& routes) {
    return start(HttpHandler{[&routes](HttpRequest request, HttpAnswer answer) {
                               routes.handle(std::move(request), std::move(answer));
                             },
                             [&routes](std::string_view target, std::size_t body_bytes) {
                               return routes.admit(target, body_bytes);
                             },
                             [this, &routes](const HttpRequest& head) {
                               return refuse(
                                   head, routes.is_free(head.target),
                                   [&](AccessFault fault) { routes.count_refused(fault); });
                             }});
  }
  std::string url() const;  ///< valid once it listens

  /// Handles SIGHUP from now on. Call it before `wait`.
  static void handle_sighup();
  static bool received_sighup();  ///< a SIGHUP came since the last call

  /// Calls back at intervals, until it is stopped.
  static void wait(const std::stop_token& stop, std::chrono::milliseconds interval,
                   const std::function<void()>& callback);

  /// Ends readiness, so that load balancers choose other servers. After the grace period it accepts
  /// no more connections, then answers the received requests. From then on no route is called.
  ///
  /// Work ends two seconds before exit-timeout-ms is over, or at half of it if that is later. One
  /// second is for clients to receive the last responses, one for threads to end. Work that still
  /// runs then, such as work that does not check for a stop, ends with the process, with exit code
  /// kExitUnfinished.
  ///
  /// finish  returns whether everything was answered by the deadline
  void drain(const std::function<void()>& set_closing,
             const std::function<bool(Clock::time_point deadline)>& finish);
  void log_end();  ///< logs the end of the drain

  static constexpr int kExitUnfinished = 75;  ///< as for work that is stopped before its end

 private:
  Result<void> start(HttpHandler handler);
  void end_by(Clock::time_point last);  ///< ends the process, if still alive
  std::optional<HttpResponse> refuse(const HttpRequest& head, bool is_free,
                                     const std::function<void(AccessFault)>& count);

  const ListenSettings settings_;
  const std::uint32_t max_arriving_mb_;
  RequestLog log_;
  BearerTokens tokens_;
  const Access access_;
  std::optional<HttpServer> server_;
  std::atomic<const HttpServer*> listening_{nullptr};  // requests may precede the end of start()
  bool is_all_answered_ = true;
  std::jthread last_resort_;  // runs while draining; last member: it needs the log
};

}  // namespace trivet::apps::service

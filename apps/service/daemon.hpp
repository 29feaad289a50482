/// The life of a program that answers over HTTP until it is told to stop.
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

/// It starts, waits, drains and ends; to be made before all that answers or writes to its log.
class Daemon {
 public:
  using Clock = std::chrono::steady_clock;

  /// max_arriving_mb  of bodies on their way, all together
  Daemon(const ListenSettings& settings, std::uint32_t max_arriving_mb)
      : settings_(settings),
        max_arriving_mb_(max_arriving_mb),
        log_(settings.log_descriptor()),
        access_(settings.host_names, settings.token_file.empty() ? nullptr : &tokens_) {}
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;

  RequestLog& log() { return log_; }
  /// Read the file of tokens, if there is one. Where that fails, the old ones stay. Errors: those of
  /// read_token_file.
  Result<void> read_tokens();
  std::size_t num_connections() const;  ///< open ones; from any thread

  /// Listen, and answer by `routes.handle` and `routes.admit`, on the network's thread, those whom
  /// Access lets in; `routes.is_free` tells what needs no token, and `routes.count_refused` is told
  /// of the others. Errors: usage (address), cannot_create (the port is taken).
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
  std::string url() const;  ///< once it listens

  /// From now on SIGHUP is taken; to be called before `wait`.
  static void take_hangups();
  static bool was_hung_up();  ///< by a SIGHUP since this was asked last

  /// Look again and again, until told to stop.
  static void wait(const std::stop_token& stop, std::chrono::milliseconds interval,
                   const std::function<void()>& look);

  /// Be ready no more, so that balancers go elsewhere; after the grace take no more connections;
  /// then answer what came in. From then on the routes are asked no more.
  ///
  /// Work ends two seconds before exit-timeout-ms is over, or at half of it if that is later: one is
  /// for clients to take the last answers, one for threads to end. What goes on at its end, such as
  /// work that does not check whether it is to stop, ends with the process: with exit code
  /// kExitUnfinished.
  ///
  /// finish  returns whether all was answered by the deadline
  void drain(const std::function<void()>& set_closing,
             const std::function<bool(Clock::time_point deadline)>& finish);
  void log_end();  ///< of the drain, to the log

  static constexpr int kExitUnfinished = 75;  ///< as of what is stopped before its end

 private:
  Result<void> start(HttpHandler handler);
  void end_by(Clock::time_point last);  ///< the process, unless this goes before
  std::optional<HttpResponse> refuse(const HttpRequest& head, bool is_free,
                                     const std::function<void(AccessFault)>& count);

  const ListenSettings settings_;
  const std::uint32_t max_arriving_mb_;
  RequestLog log_;
  BearerTokens tokens_;
  const Access access_;
  std::optional<HttpServer> server_;
  std::atomic<const HttpServer*> listening_{nullptr};  // requests come before start() has ended
  bool is_all_answered_ = true;
  std::jthread last_resort_;  // once it drains; last: it needs the log
};

}  // namespace trivet::apps::service

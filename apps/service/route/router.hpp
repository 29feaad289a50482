/// One service out of several that each hold a part of a library.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "apps/service/http/access.hpp"
#include "apps/service/http/bearer_tokens.hpp"
#include "apps/service/http/http_server.hpp"
#include "apps/service/http/request_log.hpp"
#include "apps/service/route/shard.hpp"

namespace trivet::apps::service {

struct RouterOptions {
  std::chrono::milliseconds default_deadline{10'000};  ///< of a recognition
  std::size_t max_inflight = 256;                      ///< recognitions at a time; more get 503
  std::size_t max_inflight_bytes = 512 << 20;          ///< of their bodies; more get 503
};

/// POST /v1/recognize asks all shards at once, and answers with what they found as if one library
/// had been searched; what a shard fails to answer is told as missing. GET /v1/models,
/// /v2/health/live, /v2/health/ready, /metrics. Works on a thread of its own.
class Router {
 public:
  /// Shards are asked with the first of `tokens`, if there is one. Both that and `log` outlive the
  /// router.
  Router(const std::vector<ShardAddress>& shards, const RouterOptions& options,
         const BearerTokens& tokens, RequestLog& log);
  Router(const Router&) = delete;
  Router& operator=(const Router&) = delete;
  ~Router();  ///< drops what it has not answered

  // From any thread; an answer is given from the router's own, and not after its end.
  void handle(HttpRequest request, HttpAnswer answer);
  /// Refuse what there is no room for before its body is read.
  std::optional<HttpResponse> admit(std::string_view target, std::size_t body_bytes);
  /// What needs no token: whether the router lives, and is ready.
  static bool is_free(std::string_view target);
  void count_refused(AccessFault fault);
  void set_closing();  ///< be ready no more

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace trivet::apps::service

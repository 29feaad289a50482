/// One service out of several that each hold a part of a library.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/route/shard.hpp"
#include "apps/serve/http_server.hpp"

namespace trivet::apps {

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
  /// tell  called from the router's thread with lines on what becomes of the shards
  Router(const std::vector<ShardAddress>& shards, const RouterOptions& options,
         std::function<void(const std::string&)> tell);
  Router(const Router&) = delete;
  Router& operator=(const Router&) = delete;
  ~Router();  ///< drops what it has not answered

  /// From any thread. Who answers must outlive the router's thread or be told before.
  void handle(HttpRequest request, HttpAnswer answer);
  /// Be ready no more; from any thread.
  void set_closing();
  void set_num_connections(std::function<std::size_t()> num);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace trivet::apps

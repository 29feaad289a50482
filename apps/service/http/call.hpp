/// A request on its way to its response.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "apps/service/common/request_log.hpp"
#include "apps/service/http/http_server.hpp"
#include "apps/service/http/query.hpp"
#include "apps/service/http/request_metrics.hpp"

namespace trivet::apps::service {

struct Call {
  Call(HttpRequest what, HttpAnswer whereto);
  double seconds() const;  ///< time since the request arrived
  /// Whether the timeout that the client gave in its body has passed. May be called from any
  /// thread, as may set_timeout.
  bool is_overdue() const;
  void set_timeout(std::chrono::microseconds timeout);  ///< counted from the arrival; 0: none

  HttpRequest request;
  HttpAnswer answer;
  std::string id, trace;  ///< see request_id and trace_parent
  std::size_t num_bytes;  ///< size of the body, which may have been moved out
  Target target{};        ///< valid once it was parsed
  std::string route = "other";
  bool is_logged = false;  ///< log the call even if it succeeds
  nlohmann::ordered_json log_fields = nlohmann::ordered_json::object();  ///< more for the log
  std::chrono::steady_clock::time_point begun = std::chrono::steady_clock::now();

 private:
  std::atomic<std::chrono::microseconds> timeout_{std::chrono::microseconds{0}};
};
using CallPtr = std::shared_ptr<Call>;

/// Sends responses: counts and logs them, and adds the id of the request. May be used from any
/// thread.
class Replies {
 public:
  /// metrics, log  outlive the object
  Replies(RequestMetrics& metrics, RequestLog& log) : metrics_(metrics), log_(log) {}
  /// Call once for each call.
  void send(const Call& call, HttpResponse response) const;

 private:
  void log(const Call& call, unsigned status) const;

  RequestMetrics& metrics_;
  RequestLog& log_;
};

}  // namespace trivet::apps::service

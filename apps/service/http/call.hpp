/// One request on its way to its answer.
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
  double seconds() const;  ///< since it came
  /// Whether the client waits no more, by what it said in its body. From any thread, as the next.
  bool is_overdue() const;
  void set_timeout(std::chrono::microseconds timeout);  ///< since it came; 0: none

  HttpRequest request;
  HttpAnswer answer;
  std::string id, trace;  ///< see request_id and trace_parent
  std::size_t num_bytes;  ///< of the body, which may be taken
  Target target{};        ///< once it was parsed
  std::string route = "other";
  bool is_logged = false;                                                ///< also when all is well
  nlohmann::ordered_json log_fields = nlohmann::ordered_json::object();  ///< more for the log
  std::chrono::steady_clock::time_point begun = std::chrono::steady_clock::now();

 private:
  std::atomic<std::chrono::microseconds> timeout_{std::chrono::microseconds{0}};
};
using CallPtr = std::shared_ptr<Call>;

/// Answers calls: counts them, logs them, and says to which request an answer
/// belongs. From any thread.
class Replies {
 public:
  /// Both outlive it.
  Replies(RequestMetrics& metrics, RequestLog& log) : metrics_(metrics), log_(log) {}
  /// Once for each call.
  void send(const Call& call, HttpResponse response) const;

 private:
  void log(const Call& call, unsigned status) const;

  RequestMetrics& metrics_;
  RequestLog& log_;
};

}  // namespace trivet::apps::service

/// A log of requests, one JSON object per line.
#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string_view>

namespace trivet::apps::service {

/// A separate thread writes, so that a reader that has stopped reading delays no request. Lines
/// that do not fit into the queue are dropped, the oldest first, and counted. All members may be
/// called from any thread.
class RequestLog {
 public:
  explicit RequestLog(int file_descriptor);  ///< < 0: nothing is written
  RequestLog(const RequestLog&) = delete;
  RequestLog& operator=(const RequestLog&) = delete;
  ~RequestLog();  ///< writes the remaining lines, for a second at most

  /// Writes {"ts": RFC 3339 in UTC, "level", "msg", …}.
  ///
  /// level  info, warning or error
  void write(std::string_view level, std::string_view message,
             const nlohmann::ordered_json& fields = nlohmann::ordered_json::object());
  std::uint64_t num_dropped() const;

 private:
  struct State;
  const std::unique_ptr<State> state_;
};

}  // namespace trivet::apps::service

/// What the service did, one JSON object a line.
#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string_view>

namespace trivet::apps::service {

/// A thread of its own writes, so that a reader that has stopped reading holds up no request: lines
/// that there is no room for are dropped, the oldest first, and counted. Any member may be called
/// from any thread.
class RequestLog {
 public:
  explicit RequestLog(int file_descriptor);  ///< < 0: nothing is written
  RequestLog(const RequestLog&) = delete;
  RequestLog& operator=(const RequestLog&) = delete;
  ~RequestLog();  ///< writes what is left, for a second at most

  /// Written as {"ts": RFC 3339 in UTC, "level", "msg", …}. level  info, warning or error
  void write(std::string_view level, std::string_view message,
             const nlohmann::ordered_json& fields = nlohmann::ordered_json::object());
  std::uint64_t num_dropped() const;

 private:
  struct State;
  const std::unique_ptr<State> state_;
};

}  // namespace trivet::apps::service

/// What the service did, one JSON object a line.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <thread>

namespace trivet::apps::service {

/// A thread of its own writes, so that a reader that has stopped reading holds up no request: lines
/// that it has no room for are dropped and counted. Any member may be called from any thread.
class RequestLog {
 public:
  explicit RequestLog(int file_descriptor);  ///< < 0: nothing is written
  RequestLog(const RequestLog&) = delete;
  RequestLog& operator=(const RequestLog&) = delete;
  ~RequestLog();  ///< writes what is left, for a second at most

  /// Written as {"ts": RFC 3339 in UTC, "level", "msg", …}. level  info, warning or error
  void write(std::string_view level, std::string_view message,
             const nlohmann::ordered_json& fields = nlohmann::ordered_json::object());
  std::uint64_t num_dropped() const { return num_dropped_; }

 private:
  void work();
  bool write_line(const std::string& line) const;

  const int file_descriptor_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::string> lines_;
  std::atomic<std::uint64_t> num_dropped_{0};
  std::atomic<bool> is_closed_{false};
  std::thread thread_;
};

}  // namespace trivet::apps::service

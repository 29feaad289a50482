#include "apps/service/http/request_log.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <chrono>
#include <climits>

namespace trivet::apps::service {
namespace {

constexpr std::size_t kMaxLines = 4096;
/// A pipe that is ready takes so much without blocking.
constexpr std::size_t kMaxLine = PIPE_BUF;
constexpr int kPollMs = 100;
constexpr std::chrono::seconds kLastWait{1};

std::string now() {
  using namespace std::chrono;
  const auto time = floor<milliseconds>(system_clock::now());
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", fmt::gmtime(system_clock::to_time_t(time)),
                     time.time_since_epoch().count() % 1000);
}

}  // namespace

RequestLog::RequestLog(int file_descriptor) : file_descriptor_(file_descriptor) {
  if (file_descriptor_ >= 0) thread_ = std::thread([this] { work(); });
}

RequestLog::~RequestLog() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    is_closed_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void RequestLog::write(std::string_view level, std::string_view message,
                       const nlohmann::ordered_json& fields) {
  if (file_descriptor_ < 0) return;
  using Json = nlohmann::ordered_json;
  Json json{{"ts", now()}, {"level", level}, {"msg", message}};
  json.update(fields);
  std::string line = json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  const std::lock_guard lock(mutex_);
  if (lines_.size() >= kMaxLines || line.size() > kMaxLine) {
    ++num_dropped_;
    return;
  }
  lines_.push_back(std::move(line));
  changed_.notify_all();
}

void RequestLog::work() {
  std::chrono::steady_clock::time_point last = std::chrono::steady_clock::time_point::max();
  for (;;) {
    std::string line;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return is_closed_ || !lines_.empty(); });
      if (lines_.empty()) return;
      line = std::move(lines_.front());
      lines_.pop_front();
    }
    while (!write_line(line)) {
      if (!is_closed_) continue;
      const auto time = std::chrono::steady_clock::now();
      last = std::min(last, time + kLastWait);
      if (time >= last) return;
    }
  }
}

bool RequestLog::write_line(const std::string& line) const {
  pollfd ready{file_descriptor_, POLLOUT, 0};
  if (::poll(&ready, 1, kPollMs) <= 0 || (ready.revents & POLLOUT) == 0) return false;
  (void)!::write(file_descriptor_, line.data(), line.size());  // nobody could be told
  return true;
}

}  // namespace trivet::apps::service

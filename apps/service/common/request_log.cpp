#include "apps/service/common/request_log.hpp"

#include <poll.h>
#include <spdlog/async_logger.h>
#include <spdlog/details/null_mutex.h>
#include <spdlog/details/thread_pool.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/base_sink.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <climits>
#include <string>

#include "storage/files/json_text.hpp"

namespace trivet::apps::service {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMaxLines = 4096;
/// %v is the rest of the object, after at most 53 bytes.
constexpr const char* kPattern = R"({"ts":"%Y-%m-%dT%H:%M:%S.%eZ","level":"%l",%v)";
/// A pipe that is ready accepts a line of PIPE_BUF bytes without blocking.
constexpr std::size_t kMaxText = PIPE_BUF - 64;
constexpr int kPollMs = 100;
constexpr std::chrono::seconds kLastWait{1};

/// Writes as soon as a write would not block. Without a deadline it waits for a slow reader. Lines
/// that cannot be delivered are dropped and counted.
class PatientSink : public spdlog::sinks::base_sink<spdlog::details::null_mutex> {
 public:
  explicit PatientSink(int file_descriptor)
      : base_sink(
            std::make_unique<spdlog::pattern_formatter>(kPattern, spdlog::pattern_time_type::utc)),
        file_descriptor_(file_descriptor) {}

  void wait_until(Clock::time_point last) { last_ = last; }
  void count_dropped() { ++num_dropped_; }
  std::uint64_t num_dropped() const { return num_dropped_; }

 private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    spdlog::memory_buf_t line;
    formatter_->format(message, line);
    for (;;) {
      const bool is_last = Clock::now() >= last_.load();
      pollfd reader{file_descriptor_, POLLOUT, 0};
      const bool is_signaled = ::poll(&reader, 1, is_last ? 0 : kPollMs) > 0;
      if (is_signaled && reader.revents == POLLOUT) break;
      if (is_signaled || is_last)
        return count_dropped();  // the reader has gone, or remains blocked
    }
    (void)!::write(file_descriptor_, line.data(), line.size());  // nowhere to report an error
  }
  void flush_() override {}

  const int file_descriptor_;
  std::atomic<std::uint64_t> num_dropped_{0};
  std::atomic<Clock::time_point> last_{Clock::time_point::max()};
};

}  // namespace

/// A separate queue, logger and sink: spdlog's global ones would outlive the exit.
struct RequestLog::State {
  explicit State(int file_descriptor) : sink(std::make_shared<PatientSink>(file_descriptor)) {
    // The default handler reports to standard error, which may be the blocked stream.
    logger->set_error_handler([sink = sink](const std::string&) { sink->count_dropped(); });
  }
  // Ends the thread of the queue after the last line, which the sink finishes in time.
  ~State() { sink->wait_until(Clock::now() + kLastWait); }

  const std::shared_ptr<PatientSink> sink;
  const std::shared_ptr<spdlog::details::thread_pool> queue =
      std::make_shared<spdlog::details::thread_pool>(kMaxLines, 1);
  const std::shared_ptr<spdlog::async_logger> logger = std::make_shared<spdlog::async_logger>(
      "requests", sink, queue, spdlog::async_overflow_policy::overrun_oldest);
};

RequestLog::RequestLog(int file_descriptor)
    : state_(file_descriptor < 0 ? nullptr : std::make_unique<State>(file_descriptor)) {}
RequestLog::~RequestLog() = default;

void RequestLog::write(std::string_view level, std::string_view message,
                       const nlohmann::ordered_json& fields) {
  if (!state_) return;
  using Json = nlohmann::ordered_json;
  Json json{{"msg", message}};
  json.update(fields);
  const std::string text = json_text(json).substr(1);
  if (text.size() > kMaxText) return state_->sink->count_dropped();
  state_->logger->log(spdlog::level::from_str(std::string(level)), spdlog::string_view_t(text));
}

std::uint64_t RequestLog::num_dropped() const {
  return state_ ? state_->sink->num_dropped() + state_->queue->overrun_counter() : 0;
}

}  // namespace trivet::apps::service

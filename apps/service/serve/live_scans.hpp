/// A folder that scans come into: each is recognized as it comes.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "apps/service/http/query.hpp"
#include "apps/service/http/request_log.hpp"
#include "apps/service/serve/metrics.hpp"
#include "engine/recognition_service.hpp"
#include "storage/result.hpp"

namespace trivet::apps::service {

struct LiveSettings {
  std::string folder;  ///< empty: none is watched
  std::string query;   ///< parameters of /v1/recognize, for all its scans
};

/// What lies there at the start is old; what appears later is taken once it grows no more, the
/// oldest first, one at a time. The last hundred answers are kept. Any member may be called from
/// any thread.
class LiveScans {
 public:
  /// Errors: usage (the query), missing_input (the folder).
  ///
  /// service, metrics, log  outlive it
  static Result<std::unique_ptr<LiveScans>> watch(const LiveSettings& settings,
                                                  RecognitionService& service, Metrics& metrics,
                                                  RequestLog& log);
  LiveScans(const LiveScans&) = delete;
  LiveScans& operator=(const LiveScans&) = delete;
  ~LiveScans();

  /// [{"number", "name", "query", "time", "seconds", "detections", "error"}] of those after a
  /// number, rising.
  nlohmann::ordered_json tell(std::uint64_t after) const;
  /// The answer as /v1/recognize gives it; none: no longer kept, or there was an error.
  std::shared_ptr<const std::string> answer(std::uint64_t number) const;
  /// The scan's file; none: no longer kept.
  std::optional<std::filesystem::path> file(std::uint64_t number) const;

 private:
  struct Scan {
    std::uint64_t number = 0;
    std::filesystem::path file;
    std::string error;
    double time = 0, seconds = 0;  ///< when it came, since 1970; what recognizing it took
    std::size_t num_detections = 0;
    std::shared_ptr<const std::string> answer;
  };
  /// Of a file, by which it is seen that it grows no more.
  struct Seen {
    std::uintmax_t size = 0;
    std::filesystem::file_time_type written{};
    bool is_done = false;
    bool operator==(const Seen&) const = default;
  };

  LiveScans(const LiveSettings& settings, Parameters parameters, RecognitionService& service,
            Metrics& metrics, RequestLog& log);
  /// is_old  what lies there is not to be recognized
  std::map<std::filesystem::path, Seen> look(bool is_old) const;
  void run(const std::stop_token& stop);
  void recognize(const std::filesystem::path& file, const std::stop_token& stop);
  const Scan* find(std::uint64_t number) const;

  const std::filesystem::path folder_;
  const std::string query_;
  const Parameters parameters_;
  RecognitionService& service_;
  Metrics& metrics_;
  RequestLog& log_;
  std::map<std::filesystem::path, Seen> seen_;  // of the thread
  mutable std::mutex mutex_;                    // of what follows
  std::deque<Scan> scans_;
  std::uint64_t num_scans_ = 0;
  std::jthread thread_;
};

}  // namespace trivet::apps::service

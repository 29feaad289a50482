/// A folder that scans come into: each is recognized as it comes.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "apps/service/common/request_log.hpp"
#include "apps/service/http/query.hpp"
#include "apps/service/serve/live/scan_folder.hpp"
#include "apps/service/serve/requests/metrics.hpp"
#include "engine/recognition/recognition_service.hpp"
#include "storage/common/result.hpp"

namespace trivet::apps::service {

struct LiveSettings {
  std::string folder;  ///< empty: none is watched
  std::string query;   ///< parameters of /v1/recognize, for all its scans
  std::uint32_t rest_ms =
      1000;  ///< a file that was not renamed is whole when it rested for so long
};

/// What came of a scan.
struct LiveScan {
  std::uint64_t number = 0;
  std::string name, query;       ///< of its file, as text; parameters that it was recognized with
  double time = 0, seconds = 0;  ///< when it came, since 1970; what recognizing it took
  std::size_t num_detections = 0;
  std::string error;  ///< empty: none
};

/// What lies there at the start is old; what appears or changes later is taken once it is whole (see
/// ScanFolder), the oldest first, one at a time. What goes wrong with a scan is its result: it ends
/// nothing else, and the scan is tried again when its file changes. The last hundred results are
/// kept. Any member may be called from any thread.
class LiveScans {
 public:
  /// The parameters of the query, where the folder can be watched. Errors: usage (the query),
  /// missing_input (the folder).
  static Result<Parameters> check(const LiveSettings& settings);
  /// Errors: as of check().
  ///
  /// service, metrics, log  outlive it
  static Result<std::unique_ptr<LiveScans>> watch(const LiveSettings& settings,
                                                  RecognitionService& service, Metrics& metrics,
                                                  RequestLog& log);
  LiveScans(const LiveScans&) = delete;
  LiveScans& operator=(const LiveScans&) = delete;
  ~LiveScans();

  /// New with each service: numbers of another epoch stand for other scans.
  const std::string& epoch() const noexcept { return epoch_; }
  /// Those behind a number, rising.
  std::vector<LiveScan> scans_after(std::uint64_t number) const;
  /// The answer as /v1/recognize gives it; none: no longer kept, or there was an error.
  std::shared_ptr<const std::string> answer(std::uint64_t number) const;
  /// The scan's file; none: no longer kept, or overwritten since.
  std::optional<std::filesystem::path> file(std::uint64_t number) const;

 private:
  struct Scan {
    std::uint64_t number = 0;
    std::filesystem::path file;
    FileStamp stamp;  ///< of the file as it was read
    std::string error;
    double time = 0, seconds = 0;  ///< when it came, since 1970; what recognizing it took
    std::size_t num_detections = 0;
    std::shared_ptr<const std::string> answer;
  };
  LiveScans(const LiveSettings& settings, Parameters parameters, RecognitionService& service,
            Metrics& metrics, RequestLog& log);
  void run(const std::stop_token& stop);
  /// What came of a scan; nothing: it is being written again, and comes once more.
  std::optional<Scan> recognize(const Arrival& arrival, const std::stop_token& stop);
  std::optional<Scan> try_recognize(const Arrival& arrival, const std::stop_token& stop);
  void keep(Scan scan);
  const Scan* find(std::uint64_t number) const;

  const std::string query_, epoch_;
  const Parameters parameters_;
  RecognitionService& service_;
  Metrics& metrics_;
  RequestLog& log_;
  ScanFolder folder_;         // of the thread
  mutable std::mutex mutex_;  // of what follows
  std::deque<Scan> scans_;
  std::uint64_t num_scans_ = 0;
  std::jthread thread_;
};

}  // namespace trivet::apps::service

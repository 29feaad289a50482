/// A watched folder: each scan is recognized as it arrives.
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
  std::string query;   ///< parameters of /v1/recognize, for all scans of the folder
  std::uint32_t rest_ms =
      1000;  ///< time for which a file that was not renamed must be unchanged to count as complete
};

/// The result of a scan.
struct LiveScan {
  std::uint64_t number = 0;
  std::string name, query;       ///< file name as text; parameters of the recognition
  double time = 0, seconds = 0;  ///< arrival, since 1970; duration of the recognition
  std::size_t num_detections = 0;
  std::string error;  ///< empty: none
};

/// Files that exist at the start are ignored. A file that appears or changes later is recognized
/// once it is complete (see ScanFolder), the oldest first, one at a time. An error becomes the
/// result of its scan and ends nothing else; the scan is tried again when its file changes. The
/// last hundred results are kept. All members may be called from any thread.
class LiveScans {
 public:
  /// The parameters of the query, if the folder can be watched.
  /// Errors: usage (the query), missing_input (the folder).
  static Result<Parameters> check(const LiveSettings& settings);
  /// Errors: those of check().
  ///
  /// service, metrics, log  outlive the object
  static Result<std::unique_ptr<LiveScans>> watch(const LiveSettings& settings,
                                                  RecognitionService& service, Metrics& metrics,
                                                  RequestLog& log);
  LiveScans(const LiveScans&) = delete;
  LiveScans& operator=(const LiveScans&) = delete;
  ~LiveScans();

  /// Differs for each start of the service: equal numbers of different epochs denote different
  /// scans.
  const std::string& epoch() const noexcept { return epoch_; }
  /// Scans with larger numbers, in ascending order.
  std::vector<LiveScan> scans_after(std::uint64_t number) const;
  /// The response as /v1/recognize gives it; none: no longer kept, or there was an error.
  std::shared_ptr<const std::string> answer(std::uint64_t number) const;
  /// The scan's file; none: no longer kept, or overwritten since.
  std::optional<std::filesystem::path> file(std::uint64_t number) const;

 private:
  struct Scan {
    std::uint64_t number = 0;
    std::filesystem::path file;
    FileStamp stamp;  ///< state of the file when it was read
    std::string error;
    double time = 0, seconds = 0;  ///< arrival, since 1970; duration of the recognition
    std::size_t num_detections = 0;
    std::shared_ptr<const std::string> answer;
  };
  LiveScans(const LiveSettings& settings, Parameters parameters, RecognitionService& service,
            Metrics& metrics, RequestLog& log);
  void run(const std::stop_token& stop);
  /// The result of a scan; none: the file is being written again and will be reported once more.
  std::optional<Scan> recognize(const Arrival& arrival, const std::stop_token& stop);
  std::optional<Scan> try_recognize(const Arrival& arrival, const std::stop_token& stop);
  void keep(Scan scan);
  const Scan* find(std::uint64_t number) const;

  const std::string query_, epoch_;
  const Parameters parameters_;
  RecognitionService& service_;
  Metrics& metrics_;
  RequestLog& log_;
  ScanFolder folder_;         // used by the thread only
  mutable std::mutex mutex_;  // protects the following members
  std::deque<Scan> scans_;
  std::uint64_t num_scans_ = 0;
  std::jthread thread_;
};

}  // namespace trivet::apps::service

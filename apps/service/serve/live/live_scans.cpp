#include "apps/service/serve/live/live_scans.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <future>
#include <new>
#include <random>
#include <utility>

#include "apps/service/serve/requests/recognition_job.hpp"
#include "storage/common/valid_text.hpp"
#include "storage/files/file.hpp"
#include "storage/files/json_text.hpp"

namespace trivet::apps::service {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostKept = 100;
constexpr std::uint64_t kMostBytes = 512 << 20;

double now_since_1970() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

/// The format of the contents, if the file is compressed by gzip.
std::string format_of(const fs::path& file) {
  const fs::path inner = file.extension() == ".gz" ? file.stem() : file;
  const std::string extension = inner.extension().string();
  return extension.empty() ? "" : extension.substr(1);
}

std::string new_epoch() {
  std::random_device random;
  return fmt::format("{:08x}{:08x}", random(), random());
}

/// The file name as valid UTF-8.
std::string shown_name(const fs::path& file) { return valid_utf8(file.filename().string()); }

std::string reason_of_no_answer(const ServiceOutcome& outcome) {
  if (const Error* const error = std::get_if<Error>(&outcome)) return error->message;
  switch (std::get<Refusal>(outcome)) {
    case Refusal::too_large:
      return "it needs more memory than scenes may take: serve with a larger --memory";
    case Refusal::no_memory:
      return kOutOfMemory;
    default:
      return "the service had no room for it: too many requests wait";
  }
}

}  // namespace

Result<Parameters> LiveScans::check(const LiveSettings& settings) {
  const Result<Target> target = parse_target("/?" + settings.query);
  const auto refuse = [&](const Error& error) {
    return Error{error.code, fmt::format("watch-query '{}': {}", settings.query, error.message)};
  };
  if (!target) return refuse(target.error());
  const Result<RecognizeQuery> query = parse_recognize_query(target->parameters);
  if (!query) return refuse(query.error());
  std::error_code error;
  if (!fs::is_directory(settings.folder, error)) {
    return Error{ErrorCode::missing_input,
                 fmt::format("{}: expected a folder to watch, found none", settings.folder)};
  }
  return target->parameters;
}

Result<std::unique_ptr<LiveScans>> LiveScans::watch(const LiveSettings& settings,
                                                    RecognitionService& service, Metrics& metrics,
                                                    RequestLog& log) {
  Result<Parameters> parameters = check(settings);
  if (!parameters) return parameters.error();
  return std::unique_ptr<LiveScans>(
      new LiveScans(settings, *std::move(parameters), service, metrics, log));
}

LiveScans::LiveScans(const LiveSettings& settings, Parameters parameters,
                     RecognitionService& service, Metrics& metrics, RequestLog& log)
    : query_(settings.query),
      epoch_(new_epoch()),
      parameters_(std::move(parameters)),
      service_(service),
      metrics_(metrics),
      log_(log),
      folder_(settings.folder, std::chrono::milliseconds(settings.rest_ms)),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

LiveScans::~LiveScans() = default;

void LiveScans::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    try {
      for (const Arrival& arrival : folder_.wait()) {
        if (stop.stop_requested()) return;
        if (std::optional<Scan> scan = recognize(arrival, stop)) {
          keep(*std::move(scan));
        } else {
          folder_.expect(arrival.file);
        }
      }
    } catch (const std::exception&) {
      // Out of memory for a name: the result cannot be reported either. The folder stays watched.
    }
  }
}

std::optional<LiveScans::Scan> LiveScans::recognize(const Arrival& arrival,
                                                    const std::stop_token& stop) {
  std::string reason;
  try {
    return try_recognize(arrival, stop);
  } catch (const std::bad_alloc&) {
    reason = "out of memory for this scan; give the service more, or send smaller scans";
  } catch (const std::exception& error) {
    reason = error.what();
  }
  Scan scan;
  scan.file = arrival.file;
  scan.stamp = arrival.stamp;
  scan.time = now_since_1970();
  scan.error = fmt::format("{}: {}", shown_name(arrival.file), valid_utf8(reason));
  return scan;
}

std::optional<LiveScans::Scan> LiveScans::try_recognize(const Arrival& arrival,
                                                        const std::stop_token& stop) {
  Scan scan;
  scan.file = arrival.file;
  scan.stamp = arrival.stamp;
  scan.time = now_since_1970();
  const std::string name = shown_name(arrival.file);
  if (!arrival.is_complete) {
    scan.error = fmt::format(
        "{}: is written again and again and never stays unchanged, so it is never complete; write "
        "each scan "
        "under another name and rename it, or let --watch-rest-ms be less",
        name);
    return scan;
  }
  Result<std::string> bytes = read_text_file(arrival.file, kMostBytes);
  const bool is_same = FileStamp::of(arrival.file) == arrival.stamp;
  if (!is_same || (!bytes && bytes.error().code == ErrorCode::changed)) return std::nullopt;
  const Result<RecognizeQuery> query = parse_recognize_query(parameters_);
  if (!bytes || !query) {
    scan.error = valid_utf8((bytes ? query.error() : bytes.error()).message);
    return scan;
  }
  const std::size_t num_bytes = bytes->size();
  ScanRequest request{std::make_shared<const std::string>(*std::move(bytes)), {}, query->options};
  request.scans.push_back({name, *request.body, query->scene});
  const auto recognition = std::make_shared<Recognition>(std::move(request));
  ServiceJob job = recognition_job(recognition, metrics_);
  job.num_bytes = num_bytes;
  job.is_gone = [stop] { return stop.stop_requested(); };
  std::promise<ServiceOutcome> promise;
  service_.submit(std::move(job),
                  [&](ServiceOutcome outcome) { promise.set_value(std::move(outcome)); });
  const ServiceOutcome outcome = promise.get_future().get();
  if (const auto* const answer = std::get_if<ServiceAnswer>(&outcome)) {
    scan.seconds = answer->work_seconds;
    scan.num_detections = recognition->results.front().detections.size();
    scan.answer = std::make_shared<const std::string>(
        json_text(*recognition_json(*recognition, *answer, name)));
  } else {
    scan.error = valid_utf8(reason_of_no_answer(outcome));
  }
  return scan;
}

void LiveScans::keep(Scan scan) {
  log_.write(scan.error.empty() ? "info" : "warning", "scan recognized",
             {{"file", shown_name(scan.file)},
              {"seconds", scan.seconds},
              {"detections", scan.num_detections},
              {"error", scan.error}});
  metrics_.count_scenes(scan.error.empty() ? 1 : 0, scan.error.empty() ? 0 : 1);
  const std::lock_guard lock(mutex_);
  scan.number = ++num_scans_;
  scans_.push_back(std::move(scan));
  if (scans_.size() > kMostKept) scans_.pop_front();
}

std::vector<LiveScan> LiveScans::scans_after(std::uint64_t number) const {
  std::vector<LiveScan> scans;
  const std::lock_guard lock(mutex_);
  for (const Scan& scan : scans_) {
    if (scan.number <= number) continue;
    scans.push_back(
        {scan.number, shown_name(scan.file),
         fmt::format("format={}{}{}", format_of(scan.file), query_.empty() ? "" : "&", query_),
         scan.time, scan.seconds, scan.num_detections, scan.error});
  }
  return scans;
}

const LiveScans::Scan* LiveScans::find(std::uint64_t number) const {
  const auto found = std::ranges::find(scans_, number, &Scan::number);
  return found == scans_.end() ? nullptr : &*found;
}

std::shared_ptr<const std::string> LiveScans::answer(std::uint64_t number) const {
  const std::lock_guard lock(mutex_);
  const Scan* const scan = find(number);
  return scan ? scan->answer : nullptr;
}

std::optional<fs::path> LiveScans::file(std::uint64_t number) const {
  const std::lock_guard lock(mutex_);
  const Scan* const scan = find(number);
  if (!scan || FileStamp::of(scan->file) != scan->stamp) return std::nullopt;
  return scan->file;
}

}  // namespace trivet::apps::service

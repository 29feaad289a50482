#include "apps/service/serve/live_scans.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <future>
#include <utility>
#include <vector>

#include "apps/service/serve/recognition_job.hpp"
#include "storage/file.hpp"
#include "storage/read_cloud.hpp"

namespace trivet::apps::service {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

constexpr milliseconds kPollInterval{150};
constexpr std::size_t kMostKept = 100;
constexpr std::uint64_t kMostBytes = 512 << 20;

double now_since_1970() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

/// Of what is within, where the file is packed by gzip.
std::string format_of(const fs::path& file) {
  const fs::path inner = file.extension() == ".gz" ? file.stem() : file;
  const std::string extension = inner.extension().string();
  return extension.empty() ? "" : extension.substr(1);
}

std::string reason_of_no_answer(const ServiceOutcome& outcome) {
  if (const Error* const error = std::get_if<Error>(&outcome)) return error->message;
  return "the service had no room for it: too many requests wait";
}

}  // namespace

Result<std::unique_ptr<LiveScans>> LiveScans::watch(const LiveSettings& settings,
                                                    RecognitionService& service, Metrics& metrics,
                                                    RequestLog& log) {
  const Result<Target> target = parse_target("/?" + settings.query);
  if (!target) return target.error();
  const Result<RecognizeQuery> query = parse_recognize_query(target->parameters);
  if (!query) {
    return Error{query.error().code,
                 fmt::format("watch-query '{}': {}", settings.query, query.error().message)};
  }
  std::error_code error;
  if (!fs::is_directory(settings.folder, error)) {
    return Error{ErrorCode::missing_input,
                 fmt::format("{}: expected a folder to watch, found none", settings.folder)};
  }
  return std::unique_ptr<LiveScans>(
      new LiveScans(settings, target->parameters, service, metrics, log));
}

LiveScans::LiveScans(const LiveSettings& settings, Parameters parameters,
                     RecognitionService& service, Metrics& metrics, RequestLog& log)
    : folder_(settings.folder),
      query_(settings.query),
      parameters_(std::move(parameters)),
      service_(service),
      metrics_(metrics),
      log_(log),
      seen_(look(true)),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

LiveScans::~LiveScans() = default;

std::map<fs::path, LiveScans::Seen> LiveScans::look(bool is_old) const {
  std::map<fs::path, Seen> files;
  std::error_code error;
  for (fs::directory_iterator at(folder_, error), end; !error && at != end; at.increment(error)) {
    std::error_code gone;
    const fs::path& file = at->path();
    if (!is_cloud_file(file) && !is_depth_file(file)) continue;
    const Seen seen{at->file_size(gone), at->last_write_time(gone), is_old};
    if (!gone && seen.size > 0) files.emplace(file, seen);
  }
  return files;
}

void LiveScans::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    std::this_thread::sleep_for(kPollInterval);
    std::map<fs::path, Seen> now = look(false);
    std::vector<std::pair<fs::file_time_type, fs::path>> ready;
    for (auto& [file, seen] : now) {
      const auto before = seen_.find(file);
      if (before == seen_.end() || before->second.size != seen.size ||
          before->second.written != seen.written)
        continue;  // new, or growing
      seen.is_done = true;
      if (!before->second.is_done) ready.emplace_back(seen.written, file);
    }
    seen_ = std::move(now);
    std::ranges::sort(ready);
    for (const auto& [written, file] : ready) {
      if (!stop.stop_requested()) recognize(file, stop);
    }
  }
}

void LiveScans::recognize(const fs::path& file, const std::stop_token& stop) {
  Scan scan;
  scan.file = file;
  scan.time = now_since_1970();
  const std::string name = file.filename().string();
  const Result<MappedFile> bytes = MappedFile::open(file, kMostBytes);
  const Result<RecognizeQuery> query = parse_recognize_query(parameters_);
  if (!bytes) {
    scan.error = bytes.error().message;
  } else {
    const auto view = bytes->bytes();
    ScanRequest request{std::make_shared<const std::string>(
                            reinterpret_cast<const char*>(view.data()), view.size()),
                        {},
                        query->options};
    request.scans.push_back({name, *request.body, query->scene});
    const auto recognition = std::make_shared<Recognition>(std::move(request));
    ServiceJob job = recognition_job(recognition, metrics_);
    job.num_bytes = view.size();
    job.is_gone = [stop] { return stop.stop_requested(); };
    std::promise<ServiceOutcome> promise;
    service_.submit(std::move(job),
                    [&](ServiceOutcome outcome) { promise.set_value(std::move(outcome)); });
    const ServiceOutcome outcome = promise.get_future().get();
    if (const auto* const answer = std::get_if<ServiceAnswer>(&outcome)) {
      scan.seconds = answer->work_seconds;
      scan.num_detections = recognition->results.front().detections.size();
      scan.answer =
          std::make_shared<const std::string>(recognition_json(*recognition, *answer, name).dump());
    } else {
      scan.error = reason_of_no_answer(outcome);
    }
  }
  log_.write(scan.error.empty() ? "info" : "warning", "scan recognized",
             {{"file", name},
              {"seconds", scan.seconds},
              {"detections", scan.num_detections},
              {"error", scan.error}});
  const std::lock_guard lock(mutex_);
  scan.number = ++num_scans_;
  scans_.push_back(std::move(scan));
  if (scans_.size() > kMostKept) scans_.pop_front();
}

nlohmann::ordered_json LiveScans::tell(std::uint64_t after) const {
  nlohmann::ordered_json scans = nlohmann::ordered_json::array();
  const std::lock_guard lock(mutex_);
  for (const Scan& scan : scans_) {
    if (scan.number <= after) continue;
    nlohmann::ordered_json error;
    if (!scan.error.empty()) error = scan.error;
    scans.push_back({{"number", scan.number},
                     {"name", scan.file.filename().string()},
                     {"query", fmt::format("format={}{}{}", format_of(scan.file),
                                           query_.empty() ? "" : "&", query_)},
                     {"time", scan.time},
                     {"seconds", scan.seconds},
                     {"detections", scan.num_detections},
                     {"error", std::move(error)},
                     {"url", fmt::format("/v1/live/{}/scan", scan.number)},
                     {"answer", fmt::format("/v1/live/{}/answer", scan.number)}});
  }
  return scans;
}

const LiveScans::Scan* LiveScans::find(std::uint64_t number) const {
  const auto at = std::ranges::find(scans_, number, &Scan::number);
  return at == scans_.end() ? nullptr : &*at;
}

std::shared_ptr<const std::string> LiveScans::answer(std::uint64_t number) const {
  const std::lock_guard lock(mutex_);
  const Scan* const scan = find(number);
  return scan ? scan->answer : nullptr;
}

std::optional<fs::path> LiveScans::file(std::uint64_t number) const {
  const std::lock_guard lock(mutex_);
  const Scan* const scan = find(number);
  if (!scan) return std::nullopt;
  return scan->file;
}

}  // namespace trivet::apps::service

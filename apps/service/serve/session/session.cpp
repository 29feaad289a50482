#include "apps/service/serve/session/session.hpp"

#include <fmt/format.h>

#include <system_error>
#include <utility>

#include "apps/service/own_folder.hpp"
#include "apps/service/serve/session/load_session.hpp"
#include "apps/service/serve/session/session_files.hpp"
#include "engine/common/scaled.hpp"
#include "storage/files/file.hpp"
#include "storage/files/json_file.hpp"
#include "storage/files/json_text.hpp"
#include "storage/library/model_name.hpp"

namespace trivet::apps::service {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

SessionError refuse(SessionFault fault, std::string reason) {
  return {fault, {ErrorCode::usage, std::move(reason)}};
}

SessionError unknown_scan(const std::string& name) {
  return refuse(SessionFault::unknown, fmt::format("no scan '{}'", name));
}

SessionError unknown_run(const std::string& run) {
  return refuse(SessionFault::unknown, fmt::format("no run '{}'", run));
}

SessionResult<void> check_name(std::string_view what, std::string_view name) {
  if (is_session_name(name)) return {};
  return refuse(
      SessionFault::invalid,
      fmt::format("{}: expected a letter or digit, then at most {} letters, digits, dots, "
                  "dashes and underscores, without '..', found '{}'",
                  what, kMaxSessionNameSize - 1, name.substr(0, 2 * kMaxSessionNameSize)));
}

SessionResult<FileReader> open_file(const fs::path& file) {
  std::optional<FileReader> reader = FileReader::open(file);
  if (!reader) return refuse(SessionFault::unknown, "the file is gone");
  return *std::move(reader);
}

}  // namespace

Session::Session(fs::path folder, std::uint64_t max_bytes, FileLock lock)
    : folder_(std::move(folder)),
      max_bytes_(max_bytes),
      lock_(std::move(lock)),
      contents_(load_session(folder_)) {}

Result<std::unique_ptr<Session>> Session::open(const fs::path& folder, std::uint64_t max_bytes) {
  TRIVET_TRY(claim_folder(folder, kSessionFolder));
  Result<FileLock> lock = FileLock::acquire(folder / kScansFile);
  if (!lock) return lock.error();
  remove_pending_files(folder / kManifestFile);
  return std::unique_ptr<Session>(new Session(folder, max_bytes, std::move(*lock)));
}

// Contents.

SessionContents Session::contents() const {
  const std::lock_guard lock(reading_);
  return contents_;
}

KeptScan Session::kept_scan(const std::string& name, const SessionScan& scan) const {
  return {name, contents_.files.at(scan.listed.name), contents_.unit, scan};
}

SessionResult<FileReader> Session::scan(const std::string& name) const {
  const std::lock_guard lock(reading_);
  const auto scan = contents_.scans.find(name);
  if (scan == contents_.scans.end()) return unknown_scan(name);
  return open_file(folder_ / scan->second.listed.name);
}

SessionResult<OpenAnswer> Session::answer(const std::string& run, const std::string& scan) const {
  const std::lock_guard lock(reading_);
  const auto answers = contents_.runs.find(run);
  if (answers == contents_.runs.end()) return unknown_run(run);
  const auto answer = answers->second.find(scan);
  if (answer == answers->second.end()) {
    return refuse(SessionFault::unknown, fmt::format("run '{}': no answer for '{}'", run, scan));
  }
  SessionResult<FileReader> file = open_file(folder_ / answer_file(run, scan));
  if (!file) return file.error();
  return OpenAnswer{*std::move(file), answer->second.version};
}

std::vector<SessionFile> Session::files() const {
  const std::lock_guard lock(reading_);
  std::vector<SessionFile> files;
  const auto add = [&](const std::string& name) {
    if (const auto num_bytes = regular_file_bytes(folder_ / name))
      files.push_back({name, folder_ / name, *num_bytes});
  };
  add(std::string(kSessionFolder.marker));  // lets a service accept the unpacked archive
  for (const auto& [name, bytes] : contents_.files) add(name);
  return files;
}

// Room.

bool Session::has_room(const std::string& file, std::uint64_t bytes) const {
  const auto replaced = contents_.files.find(file);
  const std::uint64_t freed =
      replaced == contents_.files.end() ? 0 : bytes_on_disk(replaced->second);
  return bytes_on_disk(contents_) - freed + bytes_on_disk(bytes) <= max_bytes_;
}

SessionError Session::refuse_bytes(std::uint64_t bytes) const {
  if (bytes > max_bytes_) {
    return refuse(SessionFault::too_large,
                  fmt::format("expected at most {} bytes, found {}; `trivet serve "
                              "--session-mb` sets how much a session may hold",
                              max_bytes_, bytes));
  }
  return refuse(
      SessionFault::full,
      fmt::format("the session is full: it holds {} of {} bytes, and {} more were to be kept; "
                  "delete scans or runs, or set `trivet serve --session-mb` higher",
                  bytes_on_disk(contents_), max_bytes_, bytes));
}

// Files.

Result<void> Session::write(const std::string& file, std::span<const std::byte> bytes) {
  const fs::path path = folder_ / file;
  TRIVET_TRY(check_below(folder_, file));
  TRIVET_TRY(make_folder(path.parent_path()));
  TRIVET_TRY(publish_file(path, bytes));
  const std::lock_guard lock(reading_);
  contents_.files[file] = bytes.size();
  return {};
}

Result<void> Session::remove(const std::string& file) {
  TRIVET_TRY(check_below(folder_, file));
  std::error_code error;
  fs::remove(folder_ / file, error);
  if (error)
    return Error{ErrorCode::io, fmt::format("{}: cannot be removed: {}", file, error.message())};
  const std::lock_guard lock(reading_);
  contents_.files.erase(file);
  return {};
}

std::set<std::string> Session::listed_models(const Scans& scans) const {
  std::set<std::string> names;
  for (const auto& [name, scan] : scans) {
    if (!scan.is_marked) continue;
    for (const TruthInstance& instance : scan.listed.truth) names.insert(instance.model);
    for (const auto& [run, answers] : contents_.runs) {
      if (const auto answer = answers.find(name); answer != answers.end())
        names.insert(answer->second.models.begin(), answer->second.models.end());
    }
  }
  return names;
}

SessionResult<void> Session::write_models(const Scans& scans, const ModelOfName& models) {
  for (const std::string& name : listed_models(scans)) {
    const std::optional<SessionModel> model = is_model_name(name) ? models(name) : std::nullopt;
    if (!model) continue;  // a model of another library: keep its mesh, if stored
    const auto known = generations_.find(name);
    if (known != generations_.end() && known->second == model->generation) continue;
    const std::string mesh = model->mesh(), file = mesh_file(name);
    if (!has_room(file, mesh.size())) return refuse_bytes(mesh.size());
    TRIVET_TRY(write(file, std::as_bytes(std::span(mesh))));
    const double scale = unit_scale(model->unit, contents_.unit);
    generations_[name] = model->generation;
    const std::lock_guard lock(reading_);
    contents_.models[name] = {name, folder_ / file, scale, engine::scaled(model->symmetry, scale)};
  }
  return {};
}

Result<void> Session::write_listings(const Scans& scans) {
  Manifest all{contents_.unit, {}, {}, {}}, marked = all;
  for (const auto& [name, scan] : scans) {
    if (scan.is_marked) marked.scenes.push_back(scan.listed);
    all.scenes.push_back(scan.listed);
    all.scenes.back().truth.clear();
  }
  for (const std::string& name : listed_models(scans)) {
    if (const auto model = contents_.models.find(name); model != contents_.models.end())
      marked.models.push_back(model->second);
  }
  for (const auto& [file, listing] : {std::pair{kScansFile, &all}, {kManifestFile, &marked}}) {
    TRIVET_TRY(check_below(folder_, file));
    TRIVET_TRY(write_manifest(folder_ / file, *listing));
    const std::lock_guard lock(reading_);
    contents_.files[file] = regular_file_bytes(folder_ / file).value_or(0);
  }
  return {};
}

// Changes of scans.

SessionResult<void> Session::check_new_scan(const std::string& name, const std::string& file,
                                            LengthUnit unit) const {
  if (contents_.scans.contains(name)) {
    return refuse(
        SessionFault::exists,
        fmt::format("scan '{}' is there already: delete it first, or choose another name", name));
  }
  if (!contents_.scans.empty() && unit != contents_.unit) {
    return refuse(SessionFault::invalid,
                  fmt::format("unit: expected {}, which the session's other scans are "
                              "in, found {}",
                              unit_name(contents_.unit), unit_name(unit)));
  }
  if (std::error_code error; fs::exists(fs::symlink_status(folder_ / file, error))) {
    return refuse(SessionFault::exists,
                  fmt::format("{}: it is there already, and no scan of the session: "
                              "choose another name, or move it away",
                              file));
  }
  return {};
}

SessionResult<KeptScan> Session::put_scan(const std::string& name, std::string_view bytes,
                                          const ScanReading& reading) {
  TRIVET_TRY(check_name("scan", name));
  const std::lock_guard change(changing_);
  const std::string file = fmt::format("scans/{}.{}", name, reading.format);
  TRIVET_TRY(check_new_scan(name, file, reading.unit));
  if (!has_room(file, bytes.size())) return refuse_bytes(bytes.size());
  TRIVET_TRY(write(file, std::as_bytes(std::span(bytes))));
  Scans next = contents_.scans;
  next[name].listed = {folder_ / file, file, reading.camera, reading.viewpoint, false, {}};
  if (contents_.scans.empty()) {
    const std::lock_guard lock(reading_);
    contents_.unit = reading.unit;
  }
  if (const Result<void> listed = write_listings(next); !listed) {
    const Result<void> removed = remove(file);
    return removed ? listed.error() : removed.error();
  }
  const std::lock_guard lock(reading_);
  contents_.scans.swap(next);
  return kept_scan(name, contents_.scans.at(name));
}

SessionResult<void> Session::delete_scan(const std::string& name) {
  const std::lock_guard change(changing_);
  const auto scan = contents_.scans.find(name);
  if (scan == contents_.scans.end()) return unknown_scan(name);
  Scans next = contents_.scans;
  next.erase(name);
  TRIVET_TRY(write_listings(next));
  std::vector<std::string> files{scan->second.listed.name};
  for (const auto& [run, answers] : contents_.runs) {
    if (answers.contains(name)) files.push_back(answer_file(run, name));
  }
  {
    const std::lock_guard lock(reading_);
    contents_.scans.swap(next);
    for (auto& [run, answers] : contents_.runs) answers.erase(name);
    std::erase_if(contents_.runs, [](const auto& run) { return run.second.empty(); });
  }
  for (const std::string& file : files) {
    TRIVET_TRY(remove(file));
  }
  return {};
}

SessionResult<KeptScan> Session::put_truth(const std::string& name, const ScanTruth& truth,
                                           const std::string& expected, const ModelOfName& models) {
  const std::lock_guard change(changing_);
  Scans next = contents_.scans;
  const auto scan = next.find(name);
  if (scan == next.end()) return unknown_scan(name);
  if (const std::string version = truth_version(scan->second);
      !expects_version(expected, version)) {
    SessionError stale = refuse(
        SessionFault::stale, fmt::format("scan '{}': expected the truth of version {}, found {}: "
                                         "someone else changed it meanwhile",
                                         name, expected, version));
    stale.kept_scan = kept_scan(name, scan->second);
    return stale;
  }
  scan->second.is_marked = truth.has_value();
  scan->second.listed.truth = truth.value_or(std::vector<TruthInstance>());
  TRIVET_TRY(write_models(next, models));
  TRIVET_TRY(write_listings(next));
  const std::lock_guard lock(reading_);
  contents_.scans.swap(next);
  return kept_scan(name, contents_.scans.at(name));
}

// Changes of runs.

SessionResult<void> Session::check_answer_version(const std::string& run, const std::string& scan,
                                                  const std::string& expected) const {
  const auto answers = contents_.runs.find(run);
  if (expected.empty() || answers == contents_.runs.end() || !answers->second.contains(scan))
    return {};
  const std::string& version = answers->second.at(scan).version;
  if (expects_version(expected, version)) return {};
  SessionError stale =
      refuse(SessionFault::stale,
             fmt::format("run '{}', scan '{}': expected the answer of version {}, found "
                         "{}: someone else changed it meanwhile",
                         run, scan, expected, version));
  stale.kept_answer = KeptAnswer{version, nullptr};
  (void)with_json(folder_ / answer_file(run, scan),
                  [&](const JsonNode& root) { stale.kept_answer->document = Json(root.value()); });
  return stale;
}

SessionResult<std::string> Session::put_answer(const std::string& run, const std::string& scan,
                                               const std::string& text, const std::string& expected,
                                               const ModelOfName& models) {
  TRIVET_TRY(check_name("run", run));
  Result<SessionAnswer> answer = read_answer(std::as_bytes(std::span(text)), "answer");
  if (!answer) return answer.error();
  const std::lock_guard change(changing_);
  const auto answered = contents_.scans.find(scan);
  if (answered == contents_.scans.end()) return unknown_scan(scan);
  TRIVET_TRY(check_answer_version(run, scan, expected));
  Json document = parse_json<Json>(text);
  document["scenes"][0]["scene"] = answered->second.listed.name;
  const std::string kept = json_text(document, 1) + "\n", file = answer_file(run, scan);
  if (!has_room(file, kept.size())) return refuse_bytes(kept.size());
  TRIVET_TRY(write(file, std::as_bytes(std::span(kept))));
  std::string version = version_of(kept);
  {
    const std::lock_guard lock(reading_);
    answer->version = version;
    contents_.runs[run][scan] = std::move(*answer);
  }
  if (answered->second.is_marked) {  // its models are listed
    TRIVET_TRY(write_models(contents_.scans, models));
    TRIVET_TRY(write_listings(contents_.scans));
  }
  return version;
}

SessionResult<void> Session::delete_run(const std::string& run) {
  const std::lock_guard change(changing_);
  const auto answers = contents_.runs.find(run);
  if (answers == contents_.runs.end()) return unknown_run(run);
  std::vector<std::string> files;
  for (const auto& [scan, answer] : answers->second) files.push_back(answer_file(run, scan));
  {
    const std::lock_guard lock(reading_);
    contents_.runs.erase(answers);
  }
  for (const std::string& file : files) {
    TRIVET_TRY(remove(file));
  }
  std::error_code not_empty;  // keep a folder that contains other files
  if (check_below(folder_, answer_file(run, "x"))) fs::remove(folder_ / "runs" / run, not_empty);
  return {};
}

}  // namespace trivet::apps::service

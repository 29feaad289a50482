#include "apps/service/serve/session/session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

#include "apps/results/detections_json.hpp"
#include "apps/service/http/file_response.hpp"
#include "apps/service/http/http_messages.hpp"
#include "apps/service/http/tar_stream.hpp"
#include "apps/service/own_folder.hpp"
#include "apps/service/serve/session/reading_query.hpp"
#include "engine/common/scaled.hpp"
#include "storage/datasets/parse_truth.hpp"
#include "storage/files/file.hpp"
#include "storage/files/json_file.hpp"
#include "storage/files/json_text.hpp"
#include "storage/library/model_name.hpp"

namespace trivet::apps::service {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr std::size_t kMaxNameSize = 64;
constexpr std::uint64_t kLeastFileBytes = 4096;  ///< that a file takes of a disk
constexpr std::uint64_t kMaxAnswerBytes = 256 << 20;
constexpr const char* kScans = "scans.json";
constexpr const char* kManifest = "manifest.json";

std::uint64_t taken(std::uint64_t bytes) { return std::max(bytes, kLeastFileBytes); }

std::string mesh_file(const std::string& model) { return fmt::format("models/{}.ply", model); }

std::string answer_file(const std::string& run, const std::string& scan) {
  return fmt::format("runs/{}/{}.json", run, scan);
}

std::optional<HttpResponse> refuse_name(std::string_view what, std::string_view name) {
  if (is_session_name(name)) return std::nullopt;
  return error_response(
      400, fmt::format("{}: expected a letter or digit, then at most {} letters, digits, dots, "
                       "dashes and underscores, without '..', found '{}'",
                       what, kMaxNameSize - 1, name.substr(0, 2 * kMaxNameSize)));
}

/// Of what is kept: the same for the same bytes.
std::string version_of(std::string_view bytes) {
  return fmt::format("\"{}\"", xxh3_hex(std::as_bytes(std::span(bytes))));
}

/// Whether the header If-Match takes a version: it names it, or any; empty: there is no condition.
bool takes_version(std::string_view match, std::string_view version) {
  return match.empty() || match == "*" || match.find(version) != std::string_view::npos;
}

/// Nothing where it is no regular file.
std::optional<std::uint64_t> bytes_of(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(fs::symlink_status(file, error))) return std::nullopt;
  const std::uint64_t bytes = fs::file_size(file, error);
  return error ? std::nullopt : std::optional(bytes);
}

std::vector<fs::directory_entry> entries_of(const fs::path& folder) {
  std::vector<fs::directory_entry> entries;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
    entries.push_back(*at);
  std::ranges::sort(entries);
  return entries;
}

}  // namespace

bool is_session_name(std::string_view name) noexcept {
  const auto is_ascii = [](char c) { return static_cast<unsigned char>(c) < 0x80; };
  return name.size() <= kMaxNameSize && std::ranges::all_of(name, is_ascii) && is_model_name(name);
}

// The start.

Result<std::unique_ptr<Session>> Session::open(const fs::path& folder, std::uint64_t max_bytes) {
  TRIVET_TRY(take_folder(folder, kSessionFolder));
  Result<FileLock> lock = FileLock::acquire(folder / kScans);
  if (!lock) return lock.error();
  remove_pending_files(folder / kManifest);
  std::unique_ptr<Session> session(new Session(folder, max_bytes, std::move(*lock)));
  session->take_files("scans");
  session->take_files("models");
  if (const std::optional<Manifest> scans = session->take_listing(kScans))
    session->take_scans(*scans);
  if (const std::optional<Manifest> marked = session->take_listing(kManifest))
    session->take_truth(*marked);
  session->take_runs();
  return session;
}

std::optional<Manifest> Session::take_listing(const char* name) {
  const fs::path file = folder_ / name;
  const std::optional<std::uint64_t> bytes = bytes_of(file);
  if (!bytes) return std::nullopt;
  Result<Manifest> listing = read_manifest(file);
  if (listing) {
    files_[name] = *bytes;
    return std::move(*listing);
  }
  const std::string aside = fmt::format("{}.damaged", name);
  std::error_code error;
  fs::rename(file, folder_ / aside, error);
  faults_.push_back({name, fmt::format("{}; it is kept as {}", listing.error().message, aside)});
  return std::nullopt;
}

/// Whether it is one, and no link that leads elsewhere, which is told.
bool Session::is_folder(const std::string& folder) {
  std::error_code error;
  const fs::file_status status = fs::symlink_status(folder_ / folder, error);
  if (fs::exists(status) && !fs::is_directory(status))
    faults_.push_back({folder, "expected a folder"});
  return fs::is_directory(status);
}

/// The regular files of a folder; what died while it wrote one left it under a temporary name.
void Session::take_files(const std::string& folder) {
  if (!is_folder(folder)) return;
  for (const fs::directory_entry& entry : entries_of(folder_ / folder)) {
    const std::string name = entry.path().filename().string();
    if (name.front() == '.') {
      std::error_code ignored;
      if (name.ends_with(".tmp")) fs::remove(entry.path(), ignored);
      continue;
    }
    const std::string file = fmt::format("{}/{}", folder, name);
    const std::optional<std::uint64_t> bytes = bytes_of(entry.path());
    if (!bytes) {
      faults_.push_back({file, "expected a regular file"});
    } else if (!is_model_name(entry.path().stem().string())) {
      faults_.push_back({file, "expected the name of a scan, run or model"});
    } else {
      files_[file] = *bytes;
    }
  }
}

void Session::take_scans(const Manifest& scans) {
  unit_ = scans.unit;
  for (const ManifestScene& scene : scans.scenes) {
    const std::string name = scene.file.stem().string();
    if (!is_session_name(name) ||
        scene.name != fmt::format("scans/{}", scene.file.filename().string())) {
      faults_.push_back({kScans, fmt::format("expected scans/NAME.EXT, found '{}'", scene.name)});
    } else if (!files_.contains(scene.name)) {
      faults_.push_back({scene.name, "the file is not there"});
    } else {
      scans_[name].listed = scene;
    }
  }
  for (const auto& [file, bytes] : files_) {
    const auto found = scans_.find(fs::path(file).stem().string());
    if (file.starts_with("scans/") && (found == scans_.end() || found->second.listed.name != file))
      faults_.push_back({file, "scans.json does not say how it is read"});
  }
}

void Session::take_truth(const Manifest& marked) {
  for (const ManifestModel& model : marked.models) {
    if (files_.contains(mesh_file(model.name))) models_[model.name] = model;
  }
  for (const ManifestScene& scene : marked.scenes) {
    const auto found = scans_.find(scene.file.stem().string());
    if (found == scans_.end() || found->second.listed.name != scene.name) {
      faults_.push_back({kManifest, fmt::format("no scan '{}'", scene.name)});
      continue;
    }
    found->second.listed.truth = scene.truth;
    found->second.is_marked = true;
  }
}

void Session::take_runs() {
  if (!is_folder("runs")) return;
  for (const fs::directory_entry& entry : entries_of(folder_ / "runs")) {
    std::error_code error;
    if (!fs::is_directory(fs::symlink_status(entry.path(), error))) continue;
    const std::string run = entry.path().filename().string();
    if (!is_session_name(run)) {
      faults_.push_back({fmt::format("runs/{}", run), "expected the name of a run"});
      continue;
    }
    const std::string folder = fmt::format("runs/{}", run);
    take_files(folder);
    for (const auto& [file, bytes] : files_) {
      if (file.starts_with(folder + "/")) take_answer(file, run, fs::path(file).stem().string());
    }
  }
}

void Session::take_answer(const std::string& file, const std::string& run,
                          const std::string& scan) {
  if (!scans_.contains(scan)) {
    faults_.push_back({file, fmt::format("no scan '{}'", scan)});
    return;
  }
  const Result<std::vector<std::byte>> bytes = read_file(folder_ / file, kMaxAnswerBytes);
  if (!bytes) return faults_.push_back({file, bytes.error().message});
  Result<Answer> answer = read_answer(*bytes, file);
  if (!answer) return faults_.push_back({file, answer.error().message});
  runs_[run][scan] = std::move(*answer);
}

Result<Session::Answer> Session::read_answer(std::span<const std::byte> bytes,
                                             const std::string& name) {
  Answer answer;
  answer.version = version_of({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  const Result<void> read = with_json(bytes, name, [&](const JsonNode& root) {
    const std::vector<JsonNode> scenes = root.at("scenes").elements();
    if (scenes.size() != 1) root.at("scenes").refuse("expected one scene");
    for (const JsonNode& detection : scenes[0].at("detections").elements()) {
      answer.models.insert(detection.at("model").string());
      detection.at("score").number();
      detection.at("T_scene_model").file_pose();
      if (detection.has("right")) detection.at("right").boolean();
      ++answer.num_found;
    }
    if (root.has("seconds")) answer.seconds = root.at("seconds").at("work").number();
  });
  if (!read) return read.error();
  return answer;
}

// What is told.

nlohmann::ordered_json Session::scan_json(const std::string& name, const Scan& scan) const {
  Json truth;
  if (scan.is_marked) truth = Json::array();
  for (const TruthInstance& instance : scan.listed.truth) {
    truth.push_back(
        {{"model", instance.model}, {"T_scene_model", matrix_json(instance.file_pose())}});
  }
  std::string version = version_of(json_text(truth));
  return {{"name", name},
          {"bytes", files_.at(scan.listed.name)},
          {"query", reading_query(scan.listed, unit_)},
          {"truth", std::move(truth)},
          {"version", std::move(version)}};
}

nlohmann::ordered_json Session::index() const {
  const std::lock_guard lock(reading_);
  Json scans = Json::array(), runs = Json::array(), faults = Json::array();
  for (const auto& [name, scan] : scans_) scans.push_back(scan_json(name, scan));
  for (const auto& [name, answers] : runs_) {
    Json list = Json::array();
    for (const auto& [scan, answer] : answers) {
      list.push_back({{"scan", scan},
                      {"found", answer.num_found},
                      {"seconds", answer.seconds ? Json(*answer.seconds) : Json()}});
    }
    runs.push_back({{"name", name}, {"answers", std::move(list)}});
  }
  for (const Fault& fault : faults_)
    faults.push_back({{"file", fault.file}, {"reason", fault.reason}});
  return {{"kept", true},
          {"unit", unit_name(unit_)},
          {"bytes", {{"used", bytes_used()}, {"allowed", max_bytes_}}},
          {"scans", std::move(scans)},
          {"runs", std::move(runs)},
          {"faults", std::move(faults)}};
}

std::size_t Session::num_scans() const {
  const std::lock_guard lock(reading_);
  return scans_.size();
}

HttpResponse Session::scan(const std::string& name) const {
  const std::lock_guard lock(reading_);
  const auto found = scans_.find(name);
  if (found == scans_.end()) return error_response(404, fmt::format("no scan '{}'", name));
  return file_response(folder_ / found->second.listed.name);
}

HttpResponse Session::answer(const std::string& run, const std::string& scan) const {
  const std::lock_guard lock(reading_);
  const auto found = runs_.find(run);
  if (found == runs_.end()) return error_response(404, fmt::format("no run '{}'", run));
  if (!found->second.contains(scan))
    return error_response(404, fmt::format("run '{}': no answer for '{}'", run, scan));
  HttpResponse response = file_response(folder_ / answer_file(run, scan), "application/json");
  response.headers.emplace_back("ETag", found->second.at(scan).version);
  return response;
}

HttpResponse Session::archive() const {
  const std::lock_guard lock(reading_);
  std::vector<TarEntry> entries;
  const auto add = [&](const std::string& file) {
    if (const auto now = bytes_of(folder_ / file))
      entries.push_back({fmt::format("session/{}", file), folder_ / file, *now});
  };
  add(std::string(kSessionFolder.marker));  // so that a service takes what is unpacked
  for (const auto& [file, bytes] : files_) add(file);
  HttpResponse response{200,
                        {},
                        "application/x-tar",
                        {{"Content-Disposition", "attachment; filename=\"session.tar\""}}};
  response.stream = tar_stream(std::move(entries));
  return response;
}

// Changes.

std::uint64_t Session::bytes_used() const {
  std::uint64_t sum = 0;
  for (const auto& [file, bytes] : files_) sum += taken(bytes);
  return sum;
}

bool Session::has_room(const std::string& file, std::uint64_t bytes) const {
  const auto there = files_.find(file);
  const std::uint64_t others = bytes_used() - (there == files_.end() ? 0 : taken(there->second));
  return others + taken(bytes) <= max_bytes_;
}

HttpResponse Session::refuse_bytes(std::uint64_t bytes) const {
  if (bytes > max_bytes_) {
    return error_response(413, fmt::format("expected at most {} bytes, found {}; `trivet serve "
                                           "--session-mb` sets how much a session may hold",
                                           max_bytes_, bytes));
  }
  return error_response(
      507, fmt::format("the session is full: it holds {} of {} bytes, and {} more were to be kept; "
                       "delete scans or runs, or set `trivet serve --session-mb` higher",
                       bytes_used(), max_bytes_, bytes));
}

Result<void> Session::write(const std::string& file, std::span<const std::byte> bytes) {
  const fs::path path = folder_ / file;
  TRIVET_TRY(check_below(folder_, file));
  TRIVET_TRY(make_folder(path.parent_path()));
  TRIVET_TRY(publish_file(path, bytes));
  const std::lock_guard lock(reading_);
  files_[file] = bytes.size();
  return {};
}

Result<void> Session::remove(const std::string& file) {
  TRIVET_TRY(check_below(folder_, file));
  std::error_code error;
  fs::remove(folder_ / file, error);
  if (error)
    return Error{ErrorCode::io, fmt::format("{}: cannot be removed: {}", file, error.message())};
  const std::lock_guard lock(reading_);
  files_.erase(file);
  return {};
}

std::set<std::string> Session::listed_models(const Scans& scans) const {
  std::set<std::string> names;
  for (const auto& [name, scan] : scans) {
    if (!scan.is_marked) continue;
    for (const TruthInstance& instance : scan.listed.truth) names.insert(instance.model);
    for (const auto& [run, answers] : runs_) {
      if (const auto answer = answers.find(name); answer != answers.end())
        names.insert(answer->second.models.begin(), answer->second.models.end());
    }
  }
  return names;
}

Result<std::optional<HttpResponse>> Session::write_models(const Scans& scans,
                                                          const ModelOfName& models) {
  for (const std::string& name : listed_models(scans)) {
    const std::optional<SessionModel> model = is_model_name(name) ? models(name) : std::nullopt;
    if (!model) continue;  // of another library: as it was kept, if it was
    const auto known = generations_.find(name);
    if (known != generations_.end() && known->second == model->generation) continue;
    const std::string mesh = model->mesh(), file = mesh_file(name);
    if (!has_room(file, mesh.size())) return std::optional(refuse_bytes(mesh.size()));
    TRIVET_TRY(write(file, std::as_bytes(std::span(mesh))));
    const double scale = unit_scale(model->unit, unit_);
    models_[name] = {name, folder_ / file, scale, engine::scaled(model->symmetry, scale)};
    generations_[name] = model->generation;
  }
  return std::optional<HttpResponse>();
}

Result<void> Session::write_listings(const Scans& scans) {
  Manifest all{unit_, {}, {}, {}}, marked = all;
  for (const auto& [name, scan] : scans) {
    if (scan.is_marked) marked.scenes.push_back(scan.listed);
    all.scenes.push_back(scan.listed);
    all.scenes.back().truth.clear();
  }
  for (const std::string& name : listed_models(scans)) {
    if (const auto model = models_.find(name); model != models_.end())
      marked.models.push_back(model->second);
  }
  for (const auto& [file, listing] : {std::pair{kScans, &all}, {kManifest, &marked}}) {
    TRIVET_TRY(check_below(folder_, file));
    TRIVET_TRY(write_manifest(folder_ / file, *listing));
    const std::lock_guard lock(reading_);
    files_[file] = bytes_of(folder_ / file).value_or(0);
  }
  return {};
}

Result<HttpResponse> Session::put_scan(const std::string& name, std::string_view bytes,
                                       const ScanReading& reading) {
  if (auto refused = refuse_name("scan", name)) return std::move(*refused);
  const std::lock_guard change(changing_);
  if (scans_.contains(name)) {
    return error_response(
        409,
        fmt::format("scan '{}' is there already: delete it first, or choose another name", name));
  }
  if (!scans_.empty() && reading.unit != unit_) {
    return error_response(400, fmt::format("unit: expected {}, which the session's other scans are "
                                           "in, found {}",
                                           unit_name(unit_), unit_name(reading.unit)));
  }
  const std::string file = fmt::format("scans/{}.{}", name, reading.format);
  if (std::error_code error; fs::exists(fs::symlink_status(folder_ / file, error))) {
    return error_response(409, fmt::format("{}: it is there already, and no scan of the session: "
                                           "choose another name, or move it away",
                                           file));
  }
  if (!has_room(file, bytes.size())) return refuse_bytes(bytes.size());
  TRIVET_TRY(write(file, std::as_bytes(std::span(bytes))));
  Scans next = scans_;
  next[name].listed = {folder_ / file, file, reading.camera, reading.viewpoint, false, {}};
  if (scans_.empty()) {
    const std::lock_guard lock(reading_);
    unit_ = reading.unit;
  }
  if (const Result<void> listed = write_listings(next); !listed) {
    const Result<void> removed = remove(file);
    return removed ? listed.error() : removed.error();
  }
  const std::lock_guard lock(reading_);
  scans_.swap(next);
  return json_response(200, scan_json(name, scans_.at(name)));
}

Result<HttpResponse> Session::delete_scan(const std::string& name) {
  const std::lock_guard change(changing_);
  const auto found = scans_.find(name);
  if (found == scans_.end()) return error_response(404, fmt::format("no scan '{}'", name));
  Scans next = scans_;
  next.erase(name);
  TRIVET_TRY(write_listings(next));
  std::vector<std::string> files{found->second.listed.name};
  for (const auto& [run, answers] : runs_) {
    if (answers.contains(name)) files.push_back(answer_file(run, name));
  }
  {
    const std::lock_guard lock(reading_);
    scans_.swap(next);
    for (auto& [run, answers] : runs_) answers.erase(name);
    std::erase_if(runs_, [](const auto& run) { return run.second.empty(); });
  }
  for (const std::string& file : files) {
    TRIVET_TRY(remove(file));
  }
  return json_response(200, {{"deleted", name}});
}

Result<HttpResponse> Session::put_truth(const std::string& name, const std::string& body,
                                        const std::string& match, const ModelOfName& models) {
  std::optional<std::vector<TruthInstance>> truth;
  const Result<void> read =
      with_json(std::as_bytes(std::span(body)), "truth", [&](const JsonNode& root) {
        if (!root.only({"truth"}).has("truth")) return;
        truth.emplace();
        for (const JsonNode& entry : root.at("truth").elements()) {
          truth->push_back(parse_truth(entry));
          const std::string& model = truth->back().model;
          if (!is_model_name(model) || !models(model))
            entry.at("model").refuse("expected a model of the library");
        }
      });
  if (!read) return read.error();
  const std::lock_guard change(changing_);
  Scans next = scans_;
  const auto scan = next.find(name);
  if (scan == next.end()) return error_response(404, fmt::format("no scan '{}'", name));
  Json now = scan_json(name, scan->second);
  if (const std::string version = now["version"]; !takes_version(match, version)) {
    return json_response(
        409,
        {{"error", fmt::format("scan '{}': expected the truth of version {}, found {}: someone "
                               "else told it meanwhile",
                               name, match, version)},
         {"scan", std::move(now)}});
  }
  scan->second.is_marked = truth.has_value();
  scan->second.listed.truth = truth.value_or(std::vector<TruthInstance>());
  const Result<std::optional<HttpResponse>> refused = write_models(next, models);
  if (!refused) return refused.error();
  if (*refused) return **refused;
  TRIVET_TRY(write_listings(next));
  const std::lock_guard lock(reading_);
  scans_.swap(next);
  return json_response(200, scan_json(name, scans_.at(name)));
}

std::optional<HttpResponse> Session::refuse_stale_answer(const std::string& run,
                                                         const std::string& scan,
                                                         const std::string& match) const {
  const auto answers = runs_.find(run);
  if (match.empty() || answers == runs_.end() || !answers->second.contains(scan))
    return std::nullopt;
  const std::string& version = answers->second.at(scan).version;
  if (takes_version(match, version)) return std::nullopt;
  Json refusal{
      {"error", fmt::format("run '{}', scan '{}': expected the answer of version {}, found "
                            "{}: someone else changed it meanwhile",
                            run, scan, match, version)},
      {"version", version},
      {"answer", nullptr}};
  (void)with_json(folder_ / answer_file(run, scan),
                  [&](const JsonNode& root) { refusal["answer"] = Json(root.value()); });
  return json_response(409, refusal);
}

Result<HttpResponse> Session::put_answer(const std::string& run, const std::string& scan,
                                         const std::string& body, const std::string& match,
                                         const ModelOfName& models) {
  if (auto refused = refuse_name("run", run)) return std::move(*refused);
  Result<Answer> answer = read_answer(std::as_bytes(std::span(body)), "answer");
  if (!answer) return answer.error();
  const std::lock_guard change(changing_);
  const auto found = scans_.find(scan);
  if (found == scans_.end()) return error_response(404, fmt::format("no scan '{}'", scan));
  if (auto stale = refuse_stale_answer(run, scan, match)) return std::move(*stale);
  Json document = parse_json<Json>(body);
  document["scenes"][0]["scene"] = found->second.listed.name;
  const std::string text = json_text(document, 1) + "\n", file = answer_file(run, scan);
  if (!has_room(file, text.size())) return refuse_bytes(text.size());
  TRIVET_TRY(write(file, std::as_bytes(std::span(text))));
  std::string version = version_of(text);
  {
    const std::lock_guard lock(reading_);
    answer->version = version;
    runs_[run][scan] = std::move(*answer);
  }
  if (found->second.is_marked) {  // its models are listed
    const Result<std::optional<HttpResponse>> refused = write_models(scans_, models);
    if (!refused) return refused.error();
    if (*refused) return **refused;
    TRIVET_TRY(write_listings(scans_));
  }
  return json_response(200, {{"run", run}, {"scan", scan}, {"version", std::move(version)}});
}

Result<HttpResponse> Session::delete_run(const std::string& run) {
  const std::lock_guard change(changing_);
  const auto found = runs_.find(run);
  if (found == runs_.end()) return error_response(404, fmt::format("no run '{}'", run));
  std::vector<std::string> files;
  for (const auto& [scan, answer] : found->second) files.push_back(answer_file(run, scan));
  {
    const std::lock_guard lock(reading_);
    runs_.erase(found);
  }
  for (const std::string& file : files) {
    TRIVET_TRY(remove(file));
  }
  std::error_code not_empty;  // what else lies there stays
  if (check_below(folder_, answer_file(run, "x"))) fs::remove(folder_ / "runs" / run, not_empty);
  return json_response(200, {{"deleted", run}});
}

}  // namespace trivet::apps::service

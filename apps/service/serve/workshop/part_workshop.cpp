#include "apps/service/serve/workshop/part_workshop.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <exception>
#include <new>
#include <set>
#include <span>
#include <utility>

#include "apps/service/own_folder.hpp"
#include "apps/service/serve/workshop/run_child.hpp"
#include "engine/libraries/edit_library.hpp"
#include "engine/training/provenance.hpp"
#include "engine/training/training_parts.hpp"
#include "storage/datasets/manifest.hpp"
#include "storage/files/file.hpp"
#include "storage/files/json_file.hpp"
#include "storage/files/json_text.hpp"
#include "storage/library/model_name.hpp"

namespace trivet::apps::service {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::string_view kManifest = "manifest.json", kLibrary = "part.h5", kFacts = "part.json";
constexpr std::uint64_t kMostFacts = 1 << 20;
constexpr std::size_t kLongestFileName = 200;
constexpr std::array<std::string_view, 4> kStateNames{"waiting", "training", "trained", "failed"};

double seconds_since(Clock::time_point begun) {
  return std::chrono::duration<double>(Clock::now() - begun).count();
}

/// The options as flags of `trivet train`, without defaults.
std::vector<std::string> flags_of(const TrainOptions& options) {
  std::vector<std::string> flags;
  for (const auto& option : options_of<TrainOptions>()) {
    const OptionValue value = option.get(options);
    if (value == option.get({})) continue;
    flags.push_back(fmt::format("--{}", option.info.name));
    const auto* const names = std::get_if<std::vector<std::string>>(&value);
    flags.push_back(names ? fmt::format("{}", fmt::join(*names, ",")) : value_text(value));
  }
  return flags;
}

/// Errors: usage: not a valid name for the file of a part.
Result<void> check_file_name(const std::string& file) {
  const bool plain = !file.empty() && file.size() <= kLongestFileName && file.front() != '.' &&
                     std::ranges::none_of(file, [](char c) {
                       return c == '/' || c == '\\' || static_cast<unsigned char>(c) < ' ';
                     });
  // The workshop writes files of these names there.
  const bool is_reserved = file == kManifest || file == kLibrary || file == kFacts;
  if (plain && !is_reserved) return {};
  return Error{ErrorCode::usage,
               fmt::format("file: expected the name of a file of up to {} characters, found '{}'",
                           kLongestFileName, file.substr(0, kLongestFileName))};
}

/// Removes the folder from the message: the client does not know where its file lies.
std::string without_folder(std::string message, const fs::path& folder) {
  for (const std::string& prefix : {std::string("error: "), folder.string() + "/"}) {
    if (const std::size_t place = message.find(prefix); place != std::string::npos)
      message.erase(place, prefix.size());
  }
  return message;
}

/// Runs a job of the thread. Any failure of a job ends only this job.
template <class F>
Result<void> run_job(F&& job) {
  try {
    return job();
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::no_memory, kOutOfMemory};  // short: it allocates no memory
  } catch (const std::exception& error) {
    return Error{ErrorCode::internal, error.what()};
  }
}

/// The files in the folder of a draft that was made from this file.
std::set<std::string> files_of(const std::string& file) {
  return {file, std::string(kManifest), std::string(kLibrary), std::string(kFacts)};
}

}  // namespace

std::string_view name_of(DraftState state) { return kStateNames[static_cast<std::size_t>(state)]; }

Result<std::unique_ptr<PartWorkshop>> PartWorkshop::open(WorkshopSettings settings,
                                                         fs::path library, Reload reload,
                                                         RequestLog& log) {
  TRIVET_TRY(claim_folder(settings.folder, kPartsFolder));
  const Result<Library> opened = open_library(library);
  if (!opened) return opened.error();
  const Result<TrainOptions> options = engine::parse_parameters(opened->header.parameters);
  if (!options) {
    return Error{options.error().code,
                 fmt::format("{}: {}; train all its models again with this version",
                             library.string(), options.error().message)};
  }
  std::unique_ptr<PartWorkshop> workshop(new PartWorkshop(std::move(settings), std::move(library),
                                                          std::move(reload), log,
                                                          opened->header.unit, flags_of(*options)));
  TRIVET_TRY(workshop->load_drafts());
  return workshop;
}

PartWorkshop::PartWorkshop(WorkshopSettings settings, fs::path library, Reload reload,
                           RequestLog& log, LengthUnit unit, std::vector<std::string> options)
    : settings_(std::move(settings)),
      library_(std::move(library)),
      reload_(std::move(reload)),
      log_(log),
      unit_(unit),
      options_(std::move(options)) {}

void PartWorkshop::start() {
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

PartWorkshop::~PartWorkshop() {
  thread_.request_stop();
  {
    const std::lock_guard lock(mutex_);
    for (auto& [name, draft] : drafts_) draft.stop.request_stop();
  }
  changed_.notify_all();
}

fs::path PartWorkshop::folder_of(const std::string& name) const {
  return fs::path(settings_.folder) / name;
}

/// Loads the drafts that an earlier service left. Other folders are ignored.
Result<void> PartWorkshop::load_drafts() {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(settings_.folder, error)) {
    const std::string name = entry.path().filename().string();
    if (folder_state(entry.path(), kPartFolder) != FolderState::own) continue;
    const Result<Manifest> manifest = read_manifest(entry.path() / kManifest);
    if (!is_model_name(name) || !manifest || manifest->models.size() != 1) continue;
    const ManifestModel& model = manifest->models.front();
    Draft draft;
    draft.file = model.file.filename().string();
    draft.num_bytes = fs::file_size(model.file, error);
    draft.unit = model.scale == 1             ? unit_
                 : unit_ == LengthUnit::meter ? LengthUnit::millimeter
                                              : LengthUnit::meter;
    drafts_.emplace(name, std::move(draft));
    queue_training(name);
  }
  if (!error) return {};
  return Error{ErrorCode::cannot_create, fmt::format("{}: {}", settings_.folder, error.message())};
}

void PartWorkshop::queue_training(const std::string& name) {
  queue([this, name] { train(name); });
}

Result<void> PartWorkshop::write_manifest_of(const std::string& name, const Draft& draft,
                                             const std::optional<Symmetry>& symmetry) const {
  const Result<void> good = check_below(settings_.folder, fs::path(name) / kManifest);
  if (!good) return good;
  Manifest manifest;
  manifest.unit = unit_;
  manifest.models.push_back(
      {name, folder_of(name) / draft.file, unit_scale(draft.unit, unit_), symmetry});
  return write_manifest(folder_of(name) / kManifest, manifest);
}

Result<void> PartWorkshop::bring(const std::string& name, const std::string& file, LengthUnit unit,
                                 std::string_view bytes) {
  if (!is_model_name(name)) {
    return Error{ErrorCode::usage,
                 fmt::format("expected a name of {}, found '{}'", kModelNameRule, name)};
  }
  TRIVET_TRY(check_file_name(file));
  const std::lock_guard one_at_a_time(files_mutex_);
  {
    const std::lock_guard lock(mutex_);
    if (!drafts_.contains(name) && drafts_.size() >= settings_.max_drafts) {
      return Error{ErrorCode::usage, fmt::format("expected at most {} drafts: publish or drop some",
                                                 settings_.max_drafts)};
    }
  }
  if (const auto refused = refuse_folder(name)) return Error{ErrorCode::usage, *refused};
  const fs::path folder = folder_of(name);
  std::error_code there;
  if (note_of(folder, kPartFolder) != file &&
      fs::exists(fs::symlink_status(folder / file, there))) {
    return Error{ErrorCode::usage,
                 fmt::format("file: '{}' lies in the part's folder already, and is not of the "
                             "workshop; choose another name",
                             file)};
  }
  if (!forget(name)) remove_folder(name);
  Draft draft;
  draft.file = file;
  draft.num_bytes = bytes.size();
  draft.unit = unit;
  Result<void> written = make_folder(folder);
  if (written) written = mark_folder(folder, kPartFolder, file);
  if (written)
    written = publish_file(folder / file, std::as_bytes(std::span(bytes.data(), bytes.size())));
  if (written) written = write_manifest_of(name, draft, std::nullopt);
  if (!written) {
    remove_folder(name);
    return written.error();
  }
  {
    const std::lock_guard lock(mutex_);
    drafts_.insert_or_assign(name, std::move(draft));
  }
  queue_training(name);
  return {};
}

Result<void> PartWorkshop::declare(const std::string& name,
                                   const std::optional<Symmetry>& symmetry) {
  const std::lock_guard one_at_a_time(files_mutex_);
  {
    const std::lock_guard lock(mutex_);
    const auto found = drafts_.find(name);
    if (found == drafts_.end() || found->second.state != DraftState::trained)
      return Error{ErrorCode::usage, fmt::format("no trained draft '{}'", name)};
    TRIVET_TRY(write_manifest_of(name, found->second, symmetry));
    found->second.state = DraftState::waiting;
    found->second.library.reset();
  }
  queue_training(name);
  return {};
}

Result<void> PartWorkshop::drop(const std::string& name) {
  const std::lock_guard one_at_a_time(files_mutex_);
  return forget(name);
}

Result<void> PartWorkshop::forget(const std::string& name) {
  {
    const std::lock_guard lock(mutex_);
    const auto found = drafts_.find(name);
    if (found == drafts_.end()) return Error{ErrorCode::usage, fmt::format("no draft '{}'", name)};
    found->second.stop.request_stop();
    drafts_.erase(found);
  }
  remove_folder(name);
  return {};
}

/// Removes the workshop's files from the folder, even if the draft is damaged and therefore
/// unknown.
void PartWorkshop::remove_folder(const std::string& name) const {
  const fs::path folder = folder_of(name);
  const std::optional<std::string> file = note_of(folder, kPartFolder);
  if (!file || folder_state(folder, kPartFolder) != FolderState::own) return;
  const fs::path parts = engine::parts_folder(kLibrary);
  if (check_below(folder, parts / "any")) engine::remove_parts(folder / parts, {});
  remove_own_folder(folder, kPartFolder, files_of(*file));
}

bool PartWorkshop::has(const std::string& name) const {
  const std::lock_guard lock(mutex_);
  return drafts_.contains(name);
}

std::optional<std::string> PartWorkshop::refuse_folder(const std::string& name) const {
  if (!is_model_name(name)) return std::nullopt;  // no folder either
  if (folder_state(folder_of(name), kPartFolder) != FolderState::foreign) return std::nullopt;
  return fmt::format(
      "part '{}': expected nothing of this name in the workshop's folder, or a part, with the file "
      "{}, found something else, which stays; choose another name, or move it away",
      name, kPartFolder.marker);
}

void PartWorkshop::train(const std::string& name) {
  std::stop_token stop;
  {
    const std::lock_guard lock(mutex_);
    const auto found = drafts_.find(name);
    if (found == drafts_.end() || found->second.state != DraftState::waiting) return;
    found->second.state = DraftState::training;
    found->second.begun = Clock::now();
    stop = found->second.stop.get_token();
  }
  Draft made;
  const Result<void> done = run_job([&] { return train_and_read(name, stop, made); });
  const std::lock_guard lock(mutex_);
  const auto found = drafts_.find(name);
  // A new draft of this name may have come meanwhile.
  if (found == drafts_.end() || found->second.stop.get_token() != stop) return;
  Draft& draft = found->second;
  draft.seconds = seconds_since(draft.begun);
  draft.error = done ? "" : without_folder(done.error().message, folder_of(name));
  draft.facts = std::move(made.facts);
  draft.library = std::move(made.library);
  draft.state =
      done ? DraftState::trained : DraftState::failed;  // last: it may still run out of memory
  log_.write(done ? "info" : "warning", done ? "part trained" : "part not trained",
             {{"model", name}, {"seconds", draft.seconds}, {"error", draft.error}});
}

Result<void> PartWorkshop::train_and_read(const std::string& name, const std::stop_token& stop,
                                          Draft& out) const {
  const fs::path folder = folder_of(name);
  for (const fs::path& file : {fs::path(kManifest), fs::path(kLibrary), fs::path(kFacts),
                               engine::parts_folder(kLibrary) / "any"}) {
    TRIVET_TRY(check_below(settings_.folder, name / file));
  }
  std::vector<std::string> program{settings_.program,
                                   "train",
                                   (folder / kManifest).string(),
                                   "-o",
                                   (folder / kLibrary).string(),
                                   "--json",
                                   (folder / kFacts).string(),
                                   "--prune"};
  program.insert(program.end(), options_.begin(), options_.end());
  ChildLimits limits;
  limits.time = std::chrono::seconds(settings_.max_seconds);
  TRIVET_TRY(run_child(program, limits, stop));
  const Result<std::string> facts = read_text_file(folder / kFacts, kMostFacts);
  if (!facts) return facts.error();
  const auto json = parse_json<nlohmann::ordered_json>(*facts);
  if (json.is_object() && json.contains("models") && json["models"].size() == 1)
    out.facts = json["models"][0];
  Result<Library> library = open_library(folder / kLibrary);
  if (!library) return library.error();
  if (library->models.size() != 1) return Error{ErrorCode::internal, "expected one trained model"};
  TRIVET_TRY(library->surface(0));
  out.library = std::make_shared<const Library>(std::move(*library));
  return {};
}

void PartWorkshop::publish(const std::string& name, Done done) {
  change(
      "part published", name,
      [this, name]() -> Result<void> {
        const std::shared_ptr<const Library> draft = trained(name);
        if (!draft) return Error{ErrorCode::usage, fmt::format("no trained draft '{}'", name)};
        return copy_models(*draft, library_, settings_.max_models);
      },
      std::move(done), [this, name] { (void)drop(name); });
}

void PartWorkshop::remove(const std::string& model, Done done) {
  change(
      "model removed", model,
      [this, model] {
        return remove_models(library_, {&model, 1});
      },
      std::move(done));
}

void PartWorkshop::rename(const std::string& from, const std::string& to, Done done) {
  change(
      "model renamed", from, [this, from, to] { return rename_model(library_, from, to); },
      std::move(done));
}

/// Edits the library's file and calls back with the result.
void PartWorkshop::change(std::string_view what, const std::string& name,
                          std::function<Result<void>()> edit, Done done,
                          std::function<void()> after) {
  const auto is_answered = std::make_shared<std::atomic<bool>>(false);
  const auto answer_once = [is_answered, done = std::move(done)](const Result<void>& outcome) {
    if (!is_answered->exchange(true)) done(outcome);
  };
  queue([this, what, name, edit = std::move(edit), answer_once, after = std::move(after)] {
    if (thread_.get_stop_token().stop_requested())
      return answer_once(Error{ErrorCode::resumable, "the service ends: ask the next one"});
    const Result<void> edited = run_job([&]() -> Result<void> {
      TRIVET_TRY(edit());
      if (after) after();
      log_.write("info", what, {{"model", name}});
      reload_(answer_once);
      return {};
    });
    if (edited) return;
    answer_once(edited);
    log_.write("warning", fmt::format("not done: {}", what),
               {{"model", name}, {"error", edited.error().message}});
  });
}

std::vector<DraftStatus> PartWorkshop::drafts() const {
  std::vector<DraftStatus> all;
  const std::lock_guard lock(mutex_);
  for (const auto& [name, draft] : drafts_) {
    const double seconds =
        draft.state == DraftState::training ? seconds_since(draft.begun) : draft.seconds;
    all.push_back({name, draft.file, draft.num_bytes, draft.unit, draft.state, seconds, draft.error,
                   draft.facts});
  }
  return all;
}

std::shared_ptr<const Library> PartWorkshop::trained(const std::string& name) const {
  const std::lock_guard lock(mutex_);
  const auto found = drafts_.find(name);
  return found == drafts_.end() ? nullptr : found->second.library;
}

void PartWorkshop::queue(Work work) {
  {
    const std::lock_guard lock(mutex_);
    work_.push_back(std::move(work));
  }
  changed_.notify_all();
}

void PartWorkshop::run(const std::stop_token& stop) {
  for (;;) {
    Work next;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return stop.stop_requested() || !work_.empty(); });
      if (work_.empty()) return;
      next = std::move(work_.front());
      work_.pop_front();
    }
    const Result<void> done = run_job([&]() -> Result<void> {
      next();
      return {};
    });
    if (!done) fail_training();  // out of memory even for the error
  }
}

/// Marks drafts as failed whose training was ended by an exception.
void PartWorkshop::fail_training() noexcept {
  const std::lock_guard lock(mutex_);
  for (auto& [name, draft] : drafts_) {
    if (draft.state != DraftState::training) continue;
    draft.state = DraftState::failed;
    draft.error = kOutOfMemory;  // short: it allocates no memory
  }
}

}  // namespace trivet::apps::service

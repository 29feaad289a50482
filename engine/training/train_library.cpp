#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <mutex>
#include <utility>

#include "engine/common/parallel.hpp"
#include "engine/libraries/assemble_library.hpp"
#include "engine/libraries/edit_library.hpp"
#include "engine/training/incremental_writer.hpp"
#include "engine/training/provenance.hpp"
#include "engine/training/standard_basis.hpp"
#include "engine/training/training_parts.hpp"
#include "engine/training/training_run.hpp"
#include "engine/training/warn_of_model.hpp"
#include "storage/common/counted.hpp"
#include "storage/files/file.hpp"
#include "storage/files/file_lock.hpp"
#include "storage/formats/read_cloud.hpp"

namespace trivet {
namespace {

using Clock = std::chrono::steady_clock;

/// Location of models by their fingerprint.
using Known = std::map<std::string, ModelCopy, std::less<>>;

void note_models(const Library& library, Known& known) {
  for (const ModelCopy& copy : copies_of(library)) {
    const std::string& fingerprint = copy.info().fingerprint;
    if (!fingerprint.empty()) known.emplace(fingerprint, copy);
  }
}

/// The model in the first place that contains it; null if none does.
const ModelCopy* find_model(std::initializer_list<const Known*> places,
                            const std::string& fingerprint) {
  for (const Known* const place : places) {
    const auto found = place->find(fingerprint);
    if (found != place->end()) return &found->second;
  }
  return nullptr;
}

Result<std::vector<ModelSource>> by_name(std::vector<ModelSource> sources) {
  if (sources.empty()) return Error{ErrorCode::usage, "expected at least one model, found none"};
  std::ranges::sort(sources, {}, &ModelSource::name);
  const auto twice = std::ranges::adjacent_find(sources, {}, &ModelSource::name);
  if (twice != sources.end()) {
    return Error{ErrorCode::bad_data,
                 fmt::format("model '{}': expected each name once, found it for {} and {}; rename "
                             "one with NAME=FILE",
                             twice->name, twice->file.string(), std::next(twice)->file.string())};
  }
  return sources;
}

Result<std::string> hash_of(const std::filesystem::path& file) {
  TRIVET_TRY_ASSIGN(const std::vector<std::byte> bytes,
                    read_file(file, ReadOptions{}.max_file_bytes));
  return xxh3_hex(bytes);
}

ModelFacts facts_of(const ModelCopy& copy, ModelOrigin origin) {
  const ModelInfo& model = copy.info();
  const ModelShape shape = copy.library->shape(copy.index);
  ModelFacts facts;
  facts.name = copy.name;
  facts.origin = origin;
  facts.num_vertices = shape.num_vertices;
  facts.num_triangles = shape.num_triangles;
  facts.diameter = model.diameter;
  facts.num_symmetries = model.symmetry.poses.size();
  facts.num_near_symmetries = model.near_symmetries.size();
  facts.axis = model.symmetry.axis.has_value();
  facts.near_axis = model.near_axis.has_value();
  facts.declared = model.symmetry.declared;
  facts.num_ppf_entries = shape.num_ppf_entries;
  facts.bytes = shape.bytes;
  facts.num_features = shape.num_features();
  return facts;
}

}  // namespace

struct TrainingRun::State {
  State(TrainRequest wanted, FileLock held)
      : request(std::move(wanted)),
        lock(std::move(held)),
        header(engine::library_header(request.unit, request.options)),
        basis(engine::standard_basis(request.options)) {
    request.file = lock.file();
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  TrainRequest request;  // its sources are sorted by name
  FileLock lock;
  LibraryHeader header;
  TriSpinBasis basis;
  Clock::time_point start = Clock::now();

  std::optional<Library> old;      // the previous file
  std::vector<ModelCopy> staying;  // its models that are not among the sources
  std::vector<Library> parts;
  Known kept, resumed;
  std::vector<std::string> fingerprints;  // one per source; empty: unreadable
  std::vector<std::size_t> jobs;          // sources to be trained
  std::size_t num_unreadable = 0;
  std::optional<engine::IncrementalWriter> incremental;

  std::mutex mutex;                            // guards the members below
  std::size_t num_assigned = 0;                // number of jobs handed out
  std::map<std::size_t, JobOutcome> outcomes;  // keyed by source
  std::map<std::size_t, Error> faults;         // keyed by source

  const std::vector<ModelSource>& sources() const { return request.sources; }
  std::size_t num_reused() const { return sources().size() - jobs.size() - num_unreadable; }
  std::string path() const { return request.file.string(); }
  std::string how_to_go_on() const;
  Error resumable(const Error& error) const {
    return {error.code, fmt::format("{} ({})", error.message, how_to_go_on())};
  }

  Result<void> open_old();
  Result<void> find_staying();
  Result<void> check_replaced() const;
  Result<void> read_sources(const Progress& progress);
  void plan();
  std::vector<std::size_t> first_jobs() const;
  Result<PackedModels> write_incrementally(const JobOutcome& outcome);
  Error all_faults() const;
  Result<std::vector<ModelCopy>> gather_models();
  const JobOutcome* outcome_of(const ModelCopy& copy) const;
  TrainReport report_on(const std::vector<ModelCopy>& models) const;
  bool is_as_it_was(const std::vector<ModelCopy>& models) const;
};

// With --prune the result depends on the sources alone, regardless of the previous file.
Result<void> TrainingRun::State::open_old() {
  std::error_code error;
  if (!std::filesystem::exists(request.file, error)) return {};
  Result<Library> opened = open_library(request.file);
  if (opened) {
    old = std::move(*opened);
    return {};
  }
  if (request.prune) return {};
  return Error{
      opened.error().code,
      opened.error().message + "; its models cannot stay: remove the file, or give --prune"};
}

Result<void> TrainingRun::State::find_staying() {
  if (!old || request.prune) return {};
  for (const ModelCopy& copy : copies_of(*old)) {
    if (!std::ranges::binary_search(sources(), copy.name, {}, &ModelSource::name))
      staying.push_back(copy);
  }
  if (staying.empty()) return {};
  const std::string differs = why_not_together(*old, header, basis);
  if (differs.empty()) return {};
  return Error{ErrorCode::usage,
               fmt::format("{}: {} of it, '{}' the first, {} not among the sources and would stay, "
                           "but {} trained with {}; name them, too, or let them go with --prune",
                           path(), counted(staying.size(), "model"), staying.front().name,
                           staying.size() == 1 ? "is" : "are", staying.size() == 1 ? "was" : "were",
                           differs)};
}

/// Two files may have the same model name: "bolt (1).stl" and "bolt [1].stl" both become bolt_1.
/// The later one must not replace the other unless the user requests it.
Result<void> TrainingRun::State::check_replaced() const {
  if (!old || request.prune) return {};
  for (const ModelInfo& model : old->models) {
    const auto source = std::ranges::lower_bound(sources(), model.name, {}, &ModelSource::name);
    if (source == sources().end() || source->name != model.name || !source->named_by_file) continue;
    const auto index = static_cast<std::size_t>(source - sources().begin());
    const bool same = cloud_name(model.source) == cloud_name(source->file) ||
                      model.fingerprint == fingerprints[index];
    if (same || model.source.empty()) continue;
    return Error{ErrorCode::usage,
                 fmt::format("{}: '{}' is the model of another file, {}, in {}; give this one "
                             "another name as NAME=FILE, or replace that one by {}={}",
                             source->file.string(), model.name, model.source, path(), model.name,
                             source->file.string())};
  }
  return {};
}

Result<void> TrainingRun::State::read_sources(const Progress& progress) {
  fingerprints.resize(sources().size());
  std::size_t num_done = 0;
  engine::for_each_index(sources().size(), [&](std::size_t k) {
    if (progress.stop.stop_requested()) return;
    const ModelSource& source = sources()[k];
    const Result<std::string> hash = hash_of(source.file);
    if (hash)
      fingerprints[k] = engine::fingerprint_of(source, *hash, request.unit, request.options);
    const std::lock_guard guard(mutex);
    if (!hash) faults.emplace(k, hash.error());
    progress(++num_done, sources().size(), source.name);
  });
  num_unreadable = faults.size();
  if (num_done == sources().size()) return {};
  return Error{ErrorCode::resumable, fmt::format("{}: stopped before training", path())};
}

void TrainingRun::State::plan() {
  if (old) note_models(*old, kept);
  for (const Library& part : parts) note_models(part, resumed);
  for (std::size_t k = 0; k < sources().size(); ++k) {
    const std::string& fingerprint = fingerprints[k];
    if (!fingerprint.empty() && !kept.contains(fingerprint) && !resumed.contains(fingerprint))
      jobs.push_back(k);
  }
  NamesToCome names;
  for (const ModelCopy& copy : staying) names.add(copy.name);
  for (std::size_t k = 0; k < sources().size(); ++k) {
    if (!faults.contains(k)) names.add(sources()[k].name);
  }
  incremental.emplace(request.file, header, basis, names, first_jobs());
}

/// The jobs whose models precede all others of the future library.
std::vector<std::size_t> TrainingRun::State::first_jobs() const {
  std::vector<std::size_t> first;
  for (std::size_t k = 0; k < sources().size() && first.size() < jobs.size(); ++k) {
    if (faults.contains(k)) continue;
    if (jobs[first.size()] != k) break;
    if (!staying.empty() && staying.front().name < sources()[k].name) break;
    first.push_back(k);
  }
  return first;
}

/// Returns models that the caller must store elsewhere.
Result<PackedModels> TrainingRun::State::write_incrementally(const JobOutcome& outcome) {
  Result<PackedModels> rest = outcome.fault   ? incremental->give_up()
                              : outcome.model ? incremental->add(outcome.source, outcome.model)
                                              : PackedModels{};  // another process writes it
  if (!rest) return resumable(rest.error());
  return rest;
}

std::string TrainingRun::State::how_to_go_on() const {
  return fmt::format("what was trained is kept in {}; the same command goes on with it",
                     engine::parts_folder(request.file).string());
}

Error TrainingRun::State::all_faults() const {
  const Error& first = faults.begin()->second;
  const std::string rest =
      faults.size() < sources().size() ? fmt::format(" ({})", how_to_go_on()) : std::string();
  if (faults.size() == 1)
    return {first.code, fmt::format("{}; nothing was written{}", first.message, rest)};
  Error joined{first.code, fmt::format("{} of {} models cannot be trained; nothing was written{}",
                                       faults.size(), sources().size(), rest)};
  for (const auto& [source, fault] : faults) joined.message += "\n" + fault.message;
  return joined;
}

/// The models of the future library, by name.
Result<std::vector<ModelCopy>> TrainingRun::State::gather_models() {
  parts = engine::open_parts(engine::parts_folder(request.file));
  Known trained;
  for (const Library& part : parts) note_models(part, trained);
  std::vector<ModelCopy> models = staying;
  for (std::size_t k = 0; k < sources().size(); ++k) {
    if (faults.contains(k)) continue;
    const ModelSource& source = sources()[k];
    const ModelCopy* const found = find_model({&kept, &trained}, fingerprints[k]);
    if (found == nullptr) {
      return Error{ErrorCode::io,
                   fmt::format("{}: model '{}' is not as it was at first; its file has changed "
                               "meanwhile: run the same command again",
                               source.file.string(), source.name)};
    }
    ModelCopy copy = *found;
    copy.name = source.name;
    copy.source = source.file.filename().string();
    models.push_back(std::move(copy));
  }
  std::ranges::sort(models, {}, &ModelCopy::name);
  return models;
}

/// The outcome of a model trained in this run; null for others.
const JobOutcome* TrainingRun::State::outcome_of(const ModelCopy& copy) const {
  const auto source = std::ranges::lower_bound(sources(), copy.name, {}, &ModelSource::name);
  if (source == sources().end() || source->name != copy.name) return nullptr;
  const auto found = outcomes.find(static_cast<std::size_t>(source - sources().begin()));
  return found == outcomes.end() ? nullptr : &found->second;
}

TrainReport TrainingRun::State::report_on(const std::vector<ModelCopy>& models) const {
  TrainReport report;
  std::vector<float> diameters;
  for (const ModelCopy& copy : models) diameters.push_back(copy.info().diameter);
  const std::vector<std::string> sizes = engine::warn_of_sizes(diameters, request.unit);
  for (std::size_t m = 0; m < models.size(); ++m) {
    const bool is_kept = old && models[m].library == &*old;
    ModelFacts facts = facts_of(models[m], is_kept ? ModelOrigin::kept : ModelOrigin::resumed);
    if (const JobOutcome* const outcome = outcome_of(models[m])) {
      facts.origin = ModelOrigin::trained;
      facts.times = outcome->times;
      facts.warnings = outcome->warnings;
      if (!sizes[m].empty()) facts.warnings.push_back(sizes[m]);
    }
    report.models.push_back(std::move(facts));
  }
  for (const auto& [source, fault] : faults)
    report.faults.push_back({sources()[source].name, fault});
  for (std::size_t m = 0; old && m < old->models.size(); ++m) {
    const bool stays =
        std::ranges::binary_search(models, old->models[m].name, {}, &ModelCopy::name);
    report.num_removed += stays ? 0 : 1;
  }
  report.unchanged = is_as_it_was(models);
  return report;
}

bool TrainingRun::State::is_as_it_was(const std::vector<ModelCopy>& models) const {
  return old && old->version_minor == kLibraryVersionMinor && old->header == header &&
         models.size() == old->models.size() &&
         std::ranges::all_of(models, [&](const ModelCopy& copy) {
           return copy.library == &*old && copy.name == copy.info().name &&
                  copy.source == copy.info().source;
         });
}

TrainingRun::TrainingRun(std::unique_ptr<State> state) : state_(std::move(state)) {}
TrainingRun::TrainingRun(TrainingRun&&) noexcept = default;
TrainingRun& TrainingRun::operator=(TrainingRun&&) noexcept = default;
TrainingRun::~TrainingRun() = default;

Result<TrainingRun> TrainingRun::begin(TrainRequest request, const TrainProgress& progress) {
  TRIVET_TRY(validate(request.options));
  TRIVET_TRY_ASSIGN(std::vector<ModelSource> sources, by_name(std::move(request.sources)));
  request.sources = std::move(sources);
  TRIVET_TRY_ASSIGN(FileLock lock, FileLock::acquire(request.file));

  auto state = std::make_unique<State>(std::move(request), std::move(lock));
  TRIVET_TRY(state->open_old());
  TRIVET_TRY(state->find_staying());
  state->parts = engine::recover_parts(engine::parts_folder(state->request.file));
  TRIVET_TRY(state->read_sources(progress.reading));
  TRIVET_TRY(state->check_replaced());
  state->plan();
  return TrainingRun(std::move(state));
}

const std::vector<ModelSource>& TrainingRun::sources() const noexcept { return state_->sources(); }
std::size_t TrainingRun::num_reused() const noexcept { return state_->num_reused(); }

std::optional<TrainingJob> TrainingRun::next() {
  State& state = *state_;
  const std::lock_guard guard(state.mutex);
  if (state.num_assigned == state.jobs.size()) return std::nullopt;
  const bool hopeless = !state.faults.empty() && !state.request.keep_going;
  return TrainingJob{state.jobs[state.num_assigned++], hopeless};
}

Result<PackedModels> TrainingRun::add(JobOutcome outcome) {
  Result<PackedModels> rest = state_->write_incrementally(outcome);
  if (!rest) return rest;
  outcome.model = nullptr;
  const std::lock_guard guard(state_->mutex);
  if (outcome.fault) state_->faults.emplace(outcome.source, *outcome.fault);
  state_->outcomes.emplace(outcome.source, std::move(outcome));
  return rest;
}

Result<TrainReport> TrainingRun::publish(const TrainProgress& progress) {
  State& state = *state_;
  const std::size_t num_sources = state.sources().size();
  if (const Result<void> saved = state.incremental->save_contents(); !saved)
    return state.resumable(saved.error());
  if (state.outcomes.size() < state.jobs.size()) {
    return Error{
        ErrorCode::resumable,
        fmt::format("{}: stopped after {} of {} models; {}", state.path(),
                    state.num_reused() + state.outcomes.size(), num_sources, state.how_to_go_on())};
  }
  if (!state.faults.empty() && (!state.request.keep_going || state.faults.size() == num_sources))
    return state.all_faults();

  TRIVET_TRY_ASSIGN(std::vector<ModelCopy> models, state.gather_models());
  TrainReport report = state.report_on(models);
  if (!report.unchanged) {
    std::optional<LibraryWriter> writer = state.incremental->release();
    const Result<void> written =
        writer ? finish_library(std::move(*writer), models, state.incremental->num_written(),
                                state.lock, progress.writing)
               : assemble_library(state.header, state.basis, std::move(models), state.lock,
                                  progress.writing);
    if (!written) return state.resumable(written.error());
  }
  engine::remove_parts(engine::parts_folder(state.request.file), std::move(state.parts));
  report.seconds = std::chrono::duration<double>(Clock::now() - state.start).count();
  return report;
}

Result<TrainReport> train_library(const TrainRequest& request, const TrainProgress& progress) {
  TRIVET_TRY_ASSIGN(TrainingRun run, TrainingRun::begin(request, progress));
  const std::size_t total = run.sources().size();
  std::size_t num_done = run.num_reused();
  progress.training(num_done, total, "");
  TRIVET_TRY(train_models(
      {run.sources(), request.unit, request.options, request.file}, [&] { return run.next(); },
      [&](JobOutcome outcome) {
        const std::string& name = run.sources()[outcome.source].name;
        Result<PackedModels> rest = run.add(std::move(outcome));
        if (rest) progress.training(++num_done, total, name);
        return rest;
      },
      progress.training.stop));
  return run.publish(progress);
}

}  // namespace trivet

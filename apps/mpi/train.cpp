#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "apps/mpi/commands.hpp"
#include "apps/program/train_request.hpp"
#include "engine/training/training_run.hpp"
#include "storage/files/json_text.hpp"

namespace trivet::apps::mpi {
namespace {

using Json = nlohmann::ordered_json;

// Messages name models only: each rank finds the sources itself, from the same command line.

std::string job_bytes(const TrainingJob& job, const std::vector<ModelSource>& sources) {
  return json_text(Json{{"model", sources[job.source].name}, {"check_only", job.check_only}});
}

std::string outcome_bytes(const JobOutcome& outcome, const std::vector<ModelSource>& sources) {
  Json stages = Json::array();
  for (const auto& [stage, seconds] : outcome.times.seconds) stages.push_back({stage, seconds});
  Json fault = nullptr;
  if (outcome.fault)
    fault = {{"code", static_cast<int>(outcome.fault->code)}, {"message", outcome.fault->message}};
  const Json all{{"model", sources[outcome.source].name},
                 {"fault", std::move(fault)},
                 {"stages", std::move(stages)},
                 {"warnings", outcome.warnings}};
  return json_text(all);
}

/// The index of each model in a list.
using Places = std::map<std::string, std::size_t>;

Places places_of(const std::vector<ModelSource>& sources) {
  Places places;
  for (std::size_t k = 0; k < sources.size(); ++k) places.emplace(sources[k].name, k);
  return places;
}

TrainingJob parse_job(const std::string& bytes, const Places& places) {
  const Json json = parse_json<Json>(bytes);
  return {places.at(json.at("model").get<std::string>()), json.at("check_only").get<bool>()};
}

JobOutcome parse_outcome(const std::string& bytes, const Places& places) {
  const Json json = parse_json<Json>(bytes);
  JobOutcome outcome;
  outcome.source = places.at(json.at("model").get<std::string>());
  if (const Json& fault = json.at("fault"); !fault.is_null()) {
    outcome.fault = Error{static_cast<ErrorCode>(fault.at("code").get<int>()),
                          fault.at("message").get<std::string>()};
  }
  for (const Json& stage : json.at("stages"))
    outcome.times.add(stage.at(0).get<std::string>(), stage.at(1).get<double>());
  outcome.warnings = json.at("warnings").get<std::vector<std::string>>();
  return outcome;
}

/// Trains the models of the jobs that this rank gets.
Result<void> train_share(const TrainRequest& request, const Ranks& ranks, const Worker& worker,
                         const std::stop_token& stop) {
  const Places places = places_of(request.sources);
  return train_models(
      {request.sources, request.unit, request.options, request.file, ranks.rank()},
      [&]() -> std::optional<TrainingJob> {
        const std::optional<std::string> job = worker.next();
        if (!job) return std::nullopt;
        return parse_job(*job, places);
      },
      [&](JobOutcome outcome) -> Result<PackedModels> {
        worker.done(outcome_bytes(outcome, request.sources));
        if (!outcome.model) return PackedModels{};
        return PackedModels{std::move(outcome.model)};
      },
      stop);
}

/// Rank 0's state of the whole training.
class Account {
 public:
  Account(Result<TrainingRun> run, const TrainProgress& progress)
      : run_(std::move(run)), progress_(progress) {
    if (!run_) return;
    places_ = places_of(run_->sources());
    num_done_ = run_->num_reused();
    progress_.training(num_done_, places_.size(), "");
  }
  JobBook book() {
    return {[this]() -> std::optional<std::string> {
              const std::optional<TrainingJob> job = run_ ? run_->next() : std::nullopt;
              if (!job || progress_.training.stop.stop_requested()) return std::nullopt;
              return job_bytes(*job, run_->sources());
            },
            [this](const std::string& bytes) {
              JobOutcome outcome = parse_outcome(bytes, places_);
              progress_.training(++num_done_, places_.size(), run_->sources()[outcome.source].name);
              // Writes nothing: the model itself is in a rank's part.
              [[maybe_unused]] const Result<PackedModels> added = run_->add(std::move(outcome));
            }};
  }
  Result<TrainReport> publish() {
    if (!run_) return run_.error();
    return run_->publish(progress_);
  }

 private:
  Result<TrainingRun> run_;
  const TrainProgress& progress_;
  Places places_;
  std::size_t num_done_ = 0;
};

/// Waits for all ranks without using processor time.
Result<void> meet(const Ranks& ranks, const std::stop_token& stop) {
  return share_jobs(
      ranks, {[] { return std::nullopt; }, [](const std::string&) {}},
      [](const Worker&) { return Result<void>(); }, stop);
}

Result<void> train(const TrainArguments& arguments, const Ranks& ranks, const Context& context) {
  const Result<TrainRequest> request = make_request(arguments, context.console);
  if (!request) return request.error();
  const TrainProgress progress = train_progress(context.console, context.stop);
  const auto work = [&](const Worker& worker) {
    return train_share(*request, ranks, worker, context.stop);
  };
  if (!ranks.is_first()) {
    const Result<void> shared = share_jobs(ranks, {}, work, context.stop);
    const Result<void> met = meet(ranks, context.stop);
    return shared ? met : shared;
  }
  Account account(TrainingRun::begin(*request, progress), progress);
  const Result<void> shared = share_jobs(ranks, account.book(), work, context.stop);
  const Result<TrainReport> report =
      shared || context.stop.stop_requested() ? account.publish() : shared.error();
  const Result<void> met = meet(ranks, context.stop);
  if (!report) return report.error();
  TRIVET_TRY(write_train_report(*report, *request, arguments.json, context.console));
  return met;
}

}  // namespace

void add_train(CLI::App& app, const Ranks& ranks, Context& context) {
  auto arguments = std::make_shared<TrainArguments>();
  CLI::App* command =
      app.add_subcommand("train",
                         "Train models into one library file\n\n"
                         "As trivet train, with the same bytes. Rank 0 hands the models out one by "
                         "one and writes the\n"
                         "library; all ranks train, each on all cores that it is given.");
  add_train_options(*command, *arguments);
  command->callback([arguments, &ranks, &context] {
    context.run = [arguments, &ranks, &context] { return train(*arguments, ranks, context); };
  });
}

}  // namespace trivet::apps::mpi

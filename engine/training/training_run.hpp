/// The steps of training a library, for who shares its models among processes; one process alone
/// calls train_library (engine/training/train.hpp).
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "engine/results/stage_times.hpp"
#include "engine/training/train.hpp"
#include "storage/common/result.hpp"
#include "storage/library/library.hpp"

namespace trivet {

/// One model that is to be trained.
struct TrainingJob {
  std::size_t source = 0;   ///< which of TrainingRun::sources()
  bool check_only = false;  ///< find out whether it can be trained at all, and no more
};

/// What came of a job.
struct JobOutcome {
  std::size_t source = 0;
  std::optional<Error> fault;  ///< why the model cannot be trained
  StageTimes times;
  std::vector<std::string> warnings;
  std::shared_ptr<PackedModel> model = nullptr;  ///< none where it cannot be trained, or was not
};

/// Models as they are going to lie in libraries.
using PackedModels = std::vector<std::shared_ptr<PackedModel>>;

/// What all processes of a run must agree on.
struct TrainingWork {
  std::span<const ModelSource> sources;
  LengthUnit unit = LengthUnit::meter;
  TrainOptions options;
  std::filesystem::path file;
  int writer = 0;  ///< of those that train for this file at once: 0, 1, ...
};

/// Train the models that `next` gives, until it gives none. Stages of different models overlap (a flow
/// graph with a node a stage).
///
/// next  called by one thread at a time, which may wait in it
/// done  likewise, for each job that came to its end; gives back the models that it has not kept, which
///       are kept beside the file. Where it fails, no more jobs are begun
/// stop  no more jobs are begun; those that were begun are finished and kept
/// Errors: of writing, of done.
Result<void> train_models(const TrainingWork& work,
                          const std::function<std::optional<TrainingJob>()>& next,
                          const std::function<Result<PackedModels>(JobOutcome)>& done,
                          const std::stop_token& stop);

/// A library that is being brought up to date. Holds the lock of its file.
class TrainingRun {
 public:
  /// Look at the sources, the file and what earlier runs left. Errors: as of train_library.
  static Result<TrainingRun> begin(TrainRequest request, const TrainProgress& progress);
  TrainingRun(TrainingRun&&) noexcept;
  TrainingRun& operator=(TrainingRun&&) noexcept;
  ~TrainingRun();

  const std::vector<ModelSource>& sources() const noexcept;  ///< by name
  std::size_t num_taken_over() const noexcept;               ///< of them
  /// The next job; none when all are given out. One thread at a time.
  std::optional<TrainingJob> next();
  /// Take note of an outcome. Its model is written where all before it, by name, are: those of a
  /// library from nothing are there when it is to be published. Gives back models that are not, to be
  /// kept beside the file. One thread at a time. Errors: of LibraryWriter.
  Result<PackedModels> add(JobOutcome outcome);
  /// Write the library, when all jobs came to their ends. Errors: as of train_library.
  Result<TrainReport> publish(const TrainProgress& progress);

 private:
  struct State;
  explicit TrainingRun(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace trivet

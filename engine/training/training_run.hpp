/// Steps of training a library, for callers that distribute its models over processes. A single
/// process calls train_library (engine/training/train.hpp).
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

/// One model to train.
struct TrainingJob {
  std::size_t source = 0;   ///< index in TrainingRun::sources()
  bool check_only = false;  ///< whether to only check that it can be trained
};

/// Outcome of a job.
struct JobOutcome {
  std::size_t source = 0;
  std::optional<Error> fault;  ///< reason why the model cannot be trained
  StageTimes times;
  std::vector<std::string> warnings;
  /// Null if it cannot be trained or was only checked.
  std::shared_ptr<PackedModel> model = nullptr;
};

/// Models in the form stored in libraries.
using PackedModels = std::vector<std::shared_ptr<PackedModel>>;

/// Parameters that all processes of a run share.
struct TrainingWork {
  std::span<const ModelSource> sources;
  LengthUnit unit = LengthUnit::meter;
  TrainOptions options;
  std::filesystem::path file;
  int writer = 0;  ///< index among the writers for this file: 0, 1, ...
};

/// Train the models returned by `next` until it returns none. Stages of different models overlap (a
/// flow graph with one node per stage).
///
/// next  called by one thread at a time; it may block
/// done  called likewise for each finished job; returns the models that it has not stored, which
///       are then stored beside the file. If it fails, no more jobs are started
/// stop  no more jobs are started; started ones are finished and stored
/// Errors: those of writing and of done.
Result<void> train_models(const TrainingWork& work,
                          const std::function<std::optional<TrainingJob>()>& next,
                          const std::function<Result<PackedModels>(JobOutcome)>& done,
                          const std::stop_token& stop);

/// The update of a library. It holds the lock of the file.
class TrainingRun {
 public:
  /// Inspect the sources, the file and the remains of earlier runs. Errors: as for train_library.
  static Result<TrainingRun> begin(TrainRequest request, const TrainProgress& progress);
  TrainingRun(TrainingRun&&) noexcept;
  TrainingRun& operator=(TrainingRun&&) noexcept;
  ~TrainingRun();

  const std::vector<ModelSource>& sources() const noexcept;  ///< sorted by name
  std::size_t num_reused() const noexcept;                   ///< number of reused models among them
  /// The next job; absent after the last one. Not thread-safe.
  std::optional<TrainingJob> next();
  /// Record an outcome. Its model is written once all models before it, by name, are written, so
  /// that those of a new library are already in the file when it is published. Returns other
  /// models, which the caller must store beside the file. Not thread-safe. Errors: those of
  /// LibraryWriter.
  Result<PackedModels> add(JobOutcome outcome);
  /// Write the library after all jobs have ended. Errors: as for train_library.
  Result<TrainReport> publish(const TrainProgress& progress);

 private:
  struct State;
  explicit TrainingRun(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace trivet

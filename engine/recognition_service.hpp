/// Recognition for scenes that come at any rate: bounded, never down, one library after another.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <variant>

#include "engine/recognise.hpp"
#include "storage/result.hpp"

namespace trivet {

struct ServiceOptions {
  std::size_t max_waiting = 64;               ///< jobs, 1..100000; more are refused
  std::size_t max_waiting_bytes = 512 << 20;  ///< of jobs, waiting and running, >= 1
  unsigned num_parallel =
      0;  ///< scenes at a time, 0..1024; 0: one a core. Each has its share of cores
  bool operator==(const ServiceOptions&) const = default;
};

/// Errors: usage (names the option, its range and its value).
Result<void> validate(const ServiceOptions& options);

/// A library that answers, and its number among those that this process has served: from 1.
struct LibraryGeneration {
  Recogniser recogniser;
  std::uint64_t number = 0;
};

using ServiceClock = std::chrono::steady_clock;

/// One scene, or several, of one request.
struct ServiceJob {
  /// Gives a scene by its index in `inputs`, once; called when the job's turn has come, by the
  /// thread that recognises it, so that decoding holds up nobody else.
  std::function<Result<Cloud>(std::size_t scene)> read;
  std::vector<SceneInput> inputs;  ///< one a scene
  RecogniseOptions options{};
  std::size_t num_bytes = 0;  ///< that the job holds
  ServiceClock::time_point deadline = ServiceClock::time_point::max();
  /// Whether nobody waits for the answer any more. Called from any thread; empty: somebody does.
  std::function<bool()> is_gone{};
};

/// What became of a job.
struct ServiceAnswer {
  std::shared_ptr<const LibraryGeneration> generation;  ///< that answered
  std::vector<SceneResult> results;                     ///< one a scene
  double queue_seconds = 0, work_seconds = 0;
};
enum class Refusal : std::uint8_t {
  full,      ///< as many wait as may
  too_late,  ///< the deadline passed before the answer was there
  gone,      ///< nobody waited any more
  closed,    ///< the service is being shut down
};
using ServiceOutcome = std::variant<ServiceAnswer, Refusal, Error>;

struct ServiceState {
  std::size_t num_waiting = 0, num_running = 0, num_bytes = 0;
  bool is_stuck = false;  ///< some job runs far longer than any should
};

/// A queue, and threads that take from it. All members may be called from any thread.
class RecognitionService {
 public:
  /// options  valid
  RecognitionService(const ServiceOptions& options, std::shared_ptr<const LibraryGeneration> first);
  RecognitionService(const RecognitionService&) = delete;
  RecognitionService& operator=(const RecognitionService&) = delete;
  ~RecognitionService();  ///< ends what runs, refuses what waits

  /// `done` is called once: at once when the job is refused, else from a thread of the service. A
  /// job whose deadline has passed, or that nobody waits for, is not begun; one that runs is
  /// stopped between its stages.
  void submit(ServiceJob job, std::function<void(ServiceOutcome)> done);

  /// Answer with this library from the next job on; jobs that run keep theirs.
  void publish(std::shared_ptr<const LibraryGeneration> next);
  std::shared_ptr<const LibraryGeneration> generation() const;

  /// Take no more; returns when all that was taken is answered. At `deadline` what waits is
  /// refused, and what runs is stopped at the end of its stage. Returns whether everything was
  /// answered.
  bool drain(ServiceClock::time_point deadline);

  ServiceState state() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace trivet

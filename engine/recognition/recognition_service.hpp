/// Recognition service for scenes that arrive at any rate. Its queue is bounded, it stays available
/// under overload, and its library can be replaced while it runs.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <variant>

#include "engine/loaded_library/recognizer.hpp"
#include "storage/common/result.hpp"

namespace trivet {

/// Limits of the service.
struct ServiceOptions {
  std::size_t max_waiting = 64;  ///< maximum waiting parts of jobs, 1..100000; more are refused
  std::size_t max_waiting_bytes = 512 << 20;  ///< maximum memory of waiting and running jobs, >= 1
  /// Maximum memory of all running parts together, >= 1.
  std::size_t max_working_bytes = std::size_t{1} << 62U;
  unsigned num_parallel = 0;  ///< maximum parallel parts, 0..1024; 0: one per core
  void (*on_thread_start)() noexcept = nullptr;  ///< called first by each thread of the service
  bool operator==(const ServiceOptions&) const = default;
};

/// Errors: usage (names the option, its range and its value).
Result<void> validate(const ServiceOptions& options);

/// A library that answers jobs, and its number among the libraries served by this process, from 1.
struct LibraryGeneration {
  Recognizer recognizer;
  std::uint64_t number = 0;
};

/// Clock of the deadlines.
using ServiceClock = std::chrono::steady_clock;

/// Answer of a job after all its parts are done.
struct ServiceAnswer {
  std::shared_ptr<const LibraryGeneration> generation;  ///< generation that answered
  double queue_seconds = 0;                             ///< time until the first part started
  double work_seconds = 0;  ///< time from then until the last part was done
};

/// A request, divided into parts such as scenes that are processed separately.
struct ServiceJob {
  std::size_t num_parts = 1;  ///< >= 1
  /// Process one part, called once per part on a worker thread. It returns early when stopped. All
  /// parts use the library that was current when the job was accepted. The first error is the job's
  /// error.
  std::function<Result<void>(std::size_t part, const LibraryGeneration&, std::stop_token)> work;
  /// Combine the results of the parts into the answer, on the thread of the last part; empty:
  /// nothing to do. Called once if all parts finish in time.
  std::function<void(const ServiceAnswer&)> conclude{};
  std::size_t num_bytes = 0;   ///< memory of the job from its acceptance on
  std::size_t part_bytes = 0;  ///< maximum additional memory of a running part
  ServiceClock::time_point deadline = ServiceClock::time_point::max();
  /// Whether the caller no longer waits for the answer. Called from any thread; empty: the caller
  /// waits.
  std::function<bool()> is_gone{};
};

/// Reasons why a job was not done.
enum class Refusal : std::uint8_t {
  full,       ///< queue full, or too long for this job's deadline
  too_large,  ///< a part needs more memory than the limit for all parts
  too_late,   ///< deadline passed before the answer was ready
  gone,       ///< the caller stopped waiting
  closed,     ///< the service is shutting down
  no_memory,  ///< the system was out of memory
};
/// Outcome of a job.
using ServiceOutcome = std::variant<ServiceAnswer, Refusal, Error>;

/// Current state of the service.
struct ServiceState {
  /// Parts, including those of jobs that are already answered.
  std::size_t num_waiting = 0, num_running = 0;
  std::size_t num_bytes = 0;          ///< memory of the jobs
  std::size_t num_working_bytes = 0;  ///< memory of the running parts
  /// Whether some part runs far longer than any should, or continues despite a stop request.
  bool is_stuck = false;
};

/// A queue and worker threads. All members are thread-safe.
class RecognitionService {
 public:
  /// options  valid options
  RecognitionService(const ServiceOptions& options, std::shared_ptr<const LibraryGeneration> first);
  RecognitionService(const RecognitionService&) = delete;
  RecognitionService& operator=(const RecognitionService&) = delete;
  ~RecognitionService();  ///< stops running jobs, refuses waiting ones

  /// `done` is called once: immediately if the job is refused, otherwise from a thread of the
  /// service. At its deadline, when nobody waits for it any more, or when a part fails, a job is
  /// answered without waiting for its running parts. These are asked to stop, and the job's memory
  /// lives until they have; parts that have not started are dropped. A job with more parts than may
  /// wait is an error. Throws std::bad_alloc; the job is not accepted then.
  void submit(ServiceJob job, std::function<void(ServiceOutcome)> done);
  /// Whether a job of this size would be refused now.
  bool is_full(std::size_t num_bytes) const;

  /// Use this library from the next job on. Jobs already accepted keep theirs.
  void publish(std::shared_ptr<const LibraryGeneration> next);
  std::shared_ptr<const LibraryGeneration> generation() const;

  /// Accept no more jobs and return when all accepted jobs are answered and nothing runs any more.
  /// Jobs not answered by `deadline` are refused and asked to stop. If their work ignores stop
  /// requests, this does not return. Returns whether everything was answered.
  bool drain(ServiceClock::time_point deadline);

  ServiceState state() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace trivet

/// Recognition for scenes that come at any rate: bounded, never down, one library after another.
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

/// How much the service takes on.
struct ServiceOptions {
  std::size_t max_waiting = 64;               ///< parts of jobs, 1..100000; more are refused
  std::size_t max_waiting_bytes = 512 << 20;  ///< that jobs hold, waiting and running, >= 1
  /// That the parts which are worked on may need together, >= 1.
  std::size_t max_working_bytes = std::size_t{1} << 62U;
  unsigned num_parallel = 0;                     ///< parts at a time, 0..1024; 0: one a core
  void (*on_thread_start)() noexcept = nullptr;  ///< each thread of the service calls it first
  bool operator==(const ServiceOptions&) const = default;
};

/// Errors: usage (names the option, its range and its value).
Result<void> validate(const ServiceOptions& options);

/// A library that answers, and its number among those that this process has served: from 1.
struct LibraryGeneration {
  Recognizer recognizer;
  std::uint64_t number = 0;
};

/// What deadlines are read from.
using ServiceClock = std::chrono::steady_clock;

/// Every part of a job is done.
struct ServiceAnswer {
  std::shared_ptr<const LibraryGeneration> generation;  ///< that answered
  double queue_seconds = 0;                             ///< until the first part was begun
  double work_seconds = 0;                              ///< from then until the last was done
};

/// What one request asks for: in parts, such as scenes, that are worked on each by itself.
struct ServiceJob {
  std::size_t num_parts = 1;  ///< >= 1
  /// Does a part, once, on the thread whose turn has come; ends early when stopped. All parts are
  /// done with the library that answered when the job was taken. The first error is the job's.
  std::function<Result<void>(std::size_t part, const LibraryGeneration&, std::stop_token)> work;
  /// Makes of what the parts did what is answered, on the thread of the last; empty: nothing is left
  /// to do. Once, if all parts are done in time.
  std::function<void(const ServiceAnswer&)> conclude{};
  std::size_t num_bytes = 0;   ///< that the job holds from when it is taken
  std::size_t part_bytes = 0;  ///< that a part needs beside them while it is worked on, at the most
  ServiceClock::time_point deadline = ServiceClock::time_point::max();
  /// Whether nobody waits for the answer any more. Called from any thread; empty: somebody does.
  std::function<bool()> is_gone{};
};

/// Why a job was not done.
enum class Refusal : std::uint8_t {
  full,       ///< as many wait as may, or as can be answered before this one's deadline
  too_large,  ///< a part needs more memory than all parts together may
  too_late,   ///< the deadline passed before the answer was there
  gone,       ///< nobody waited any more
  closed,     ///< the service is being shut down
  no_memory,  ///< the system had none left
};
/// How a job ended.
using ServiceOutcome = std::variant<ServiceAnswer, Refusal, Error>;

/// What the service is doing.
struct ServiceState {
  std::size_t num_waiting = 0, num_running = 0;  ///< parts; also such as are answered for already
  std::size_t num_bytes = 0;                     ///< that jobs hold
  std::size_t num_working_bytes = 0;             ///< that the parts which run need
  /// Some part runs far longer than any should, or goes on though it was told to stop.
  bool is_stuck = false;
};

/// A queue, and threads that take from it. All members may be called from any thread.
class RecognitionService {
 public:
  /// options  valid
  RecognitionService(const ServiceOptions& options, std::shared_ptr<const LibraryGeneration> first);
  RecognitionService(const RecognitionService&) = delete;
  RecognitionService& operator=(const RecognitionService&) = delete;
  ~RecognitionService();  ///< ends what runs, refuses what waits

  /// `done` is called once: at once when the job is refused, else from a thread of the service. At
  /// its deadline, when nobody waits for it any more, and when a part fails, a job is answered
  /// without waiting for the parts that are worked on: these are told to stop, and what the job holds
  /// lives until they have. Parts that were not begun by then never are. A job with more parts than
  /// may wait is an error. Throws std::bad_alloc, and then takes nothing.
  void submit(ServiceJob job, std::function<void(ServiceOutcome)> done);
  /// Whether a job of so many bytes would be refused now.
  bool is_full(std::size_t num_bytes) const;

  /// Answer with this library from the next job on; those that were taken keep theirs.
  void publish(std::shared_ptr<const LibraryGeneration> next);
  std::shared_ptr<const LibraryGeneration> generation() const;

  /// Take no more; returns when all that was taken is answered, and nothing runs any more. What is
  /// not answered by `deadline` is refused then, and told to stop: where work does not look, this
  /// does not return. Returns whether everything was answered.
  bool drain(ServiceClock::time_point deadline);

  ServiceState state() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace trivet

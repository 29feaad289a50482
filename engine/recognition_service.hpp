/// Recognition for scenes that come at any rate: bounded, never down, one library after another.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <variant>

#include "engine/recognizer.hpp"
#include "storage/result.hpp"

namespace trivet {

/// How much the service takes on.
struct ServiceOptions {
  std::size_t max_waiting = 64;               ///< parts of jobs, 1..100000; more are refused
  std::size_t max_waiting_bytes = 512 << 20;  ///< of jobs, waiting and running, >= 1
  unsigned num_parallel = 0;                  ///< parts at a time, 0..1024; 0: one a core
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

/// What one request asks for: in parts, such as scenes, that are worked on each by itself.
struct ServiceJob {
  std::size_t num_parts = 1;  ///< >= 1
  /// Does a part, once, on the thread whose turn has come; ends early when stopped. All parts are
  /// done with the library that answered when the job was taken. The first error is the job's.
  std::function<Result<void>(std::size_t part, const LibraryGeneration&, std::stop_token)> work;
  std::size_t num_bytes = 0;  ///< that the job holds
  ServiceClock::time_point deadline = ServiceClock::time_point::max();
  /// Whether nobody waits for the answer any more. Called from any thread; empty: somebody does.
  std::function<bool()> is_gone{};
};

/// Every part of a job is done.
struct ServiceAnswer {
  std::shared_ptr<const LibraryGeneration> generation;  ///< that answered
  double queue_seconds = 0;                             ///< until the first part was begun
  double work_seconds = 0;                              ///< from then until the last was done
};
/// Why a job was not done.
enum class Refusal : std::uint8_t {
  full,      ///< as many wait as may, or as can be answered before this one's deadline
  too_late,  ///< the deadline passed before the answer was there
  gone,      ///< nobody waited any more
  closed,    ///< the service is being shut down
};
/// How a job ended.
using ServiceOutcome = std::variant<ServiceAnswer, Refusal, Error>;

/// What the service is doing.
struct ServiceState {
  std::size_t num_waiting = 0, num_running = 0;  ///< parts
  std::size_t num_bytes = 0;
  bool is_stuck = false;  ///< some part runs far longer than any should
};

/// A queue, and threads that take from it. All members may be called from any thread.
class RecognitionService {
 public:
  /// options  valid
  RecognitionService(const ServiceOptions& options, std::shared_ptr<const LibraryGeneration> first);
  RecognitionService(const RecognitionService&) = delete;
  RecognitionService& operator=(const RecognitionService&) = delete;
  ~RecognitionService();  ///< ends what runs, refuses what waits

  /// `done` is called once: at once when the job is refused, else from a thread of the service,
  /// when no part of the job is worked on any more. A job whose deadline has passed, or that nobody
  /// waits for, is not begun, and stopped where it has begun. A job with more parts than may wait
  /// is an error.
  void submit(ServiceJob job, std::function<void(ServiceOutcome)> done);
  /// Whether a job of so many bytes would be refused now.
  bool is_full(std::size_t num_bytes) const;

  /// Answer with this library from the next job on; those that were taken keep theirs.
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

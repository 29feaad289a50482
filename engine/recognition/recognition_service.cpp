#include "engine/recognition_service.hpp"

#include <fmt/format.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <exception>
#include <list>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "engine/common/check_range.hpp"

namespace trivet {
namespace {

using Done = std::function<void(ServiceOutcome)>;
using Failure = std::variant<Refusal, Error>;

/// How often jobs are looked at, and how long no part should take.
constexpr std::chrono::milliseconds kLookInterval{20};
constexpr std::chrono::seconds kStuckAfter{120};
/// Of the newest part in the mean time that one takes.
constexpr double kNewestShare = 0.1;

double seconds_between(ServiceClock::time_point from, ServiceClock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

/// A job that was taken. What changes is guarded by the service's mutex.
struct Taken {
  ServiceJob job;
  Done done;
  std::shared_ptr<const LibraryGeneration> generation;
  ServiceClock::time_point since, begun{};
  std::size_t num_left = 0;  ///< parts that are not done with
  std::optional<Failure> failure{};
  std::stop_source stop{};

  void fail(Failure why) {
    if (!failure) failure = std::move(why);
    stop.request_stop();
  }
  /// Why the answer has become useless.
  std::optional<Refusal> overtaken(ServiceClock::time_point now) const {
    if (now >= job.deadline) return Refusal::too_late;
    if (job.is_gone && job.is_gone()) return Refusal::gone;
    return std::nullopt;
  }
};

struct Part {
  std::shared_ptr<Taken> of;
  std::size_t index = 0;
  ServiceClock::time_point begun{};
};

void tell(Taken& job) {
  job.job.work = {};  // the memory goes before the answer
  if (!job.failure) {
    job.done(ServiceAnswer{std::move(job.generation), seconds_between(job.since, job.begun),
                           seconds_between(job.begun, ServiceClock::now())});
    return;
  }
  job.generation.reset();
  std::visit([&](auto& why) { job.done(std::move(why)); }, *job.failure);
}

}  // namespace

struct RecognitionService::State {
  State(const ServiceOptions& service_options, std::shared_ptr<const LibraryGeneration> first)
      : options(service_options), generation(std::move(first)) {
    num_cores = tbb::this_task_arena::max_concurrency();
    const unsigned num_workers =
        options.num_parallel > 0 ? options.num_parallel : static_cast<unsigned>(num_cores);
    for (unsigned i = 0; i < num_workers; ++i) workers.emplace_back([this] { work(); });
    watch = std::jthread([this](const std::stop_token& stop) { look_after(stop); });
  }

  ~State() {
    close(Refusal::closed);
    workers.clear();  // joins
  }

  bool is_full(std::size_t num_parts, std::size_t num_more) const {
    return waiting.size() + num_parts > options.max_waiting ||
           num_bytes + num_more > options.max_waiting_bytes;
  }

  /// Whether a job would be answered after its deadline, if what waits takes as long as what was
  /// done last. Work that is begun and not answered in time is lost, and under overload all would
  /// be. Never where a worker is free: or a mean that is too long would refuse all and stay.
  bool would_be_late(const Taken& job) const {
    if (waiting.empty() && running.size() < workers.size()) return false;
    const auto num_turns =
        static_cast<double>(waiting.size() + job.num_left) / static_cast<double>(workers.size());
    return mean_seconds * (num_turns + 0.5) > seconds_between(job.since, job.job.deadline);
  }

  /// Take no more, drop what waits, stop what runs.
  void close(Refusal why) {
    {
      const std::lock_guard lock(mutex);
      is_closed = true;
      for (const Part& part : running) part.of->fail(why);
    }
    drop_waiting([&](const Taken&) { return std::optional(why); });
    changed.notify_all();
  }

  /// Count parts that are done with. Returns whether the job is. Pre: locked.
  bool finish(Taken& job, std::size_t num_parts) {
    job.num_left -= num_parts;
    if (job.num_left > 0) return false;
    num_bytes -= job.job.num_bytes;
    return true;
  }

  /// Take out of the queue what there is a reason to fail.
  template <class Why>
  void drop_waiting(const Why& why) {
    std::vector<std::shared_ptr<Taken>> told;
    {
      const std::lock_guard lock(mutex);
      std::erase_if(waiting, [&](const Part& part) {
        if (!part.of->failure) {
          const std::optional<Refusal> refusal = why(*part.of);
          if (!refusal) return false;
          part.of->fail(*refusal);
        }
        if (finish(*part.of, 1)) told.push_back(part.of);
        return true;
      });
      num_telling += told.size();
    }
    for (const std::shared_ptr<Taken>& job : told) tell(*job);
    {
      const std::lock_guard lock(mutex);
      num_telling -= told.size();
    }
    changed.notify_all();
  }

  void work() {
    // Each may use all cores: a scene alone has them to itself, and many share them.
    tbb::task_arena arena(num_cores);
    for (;;) {
      std::list<Part>::iterator part;
      {
        std::unique_lock lock(mutex);
        changed.wait(lock, [&] { return is_closed || !waiting.empty(); });
        if (waiting.empty()) return;
        running.push_back(std::move(waiting.front()));
        waiting.pop_front();
        part = std::prev(running.end());
        part->begun = ServiceClock::now();
        Taken& job = *part->of;
        if (job.begun == ServiceClock::time_point{}) job.begun = part->begun;
        if (const std::optional<Refusal> refusal = job.overtaken(part->begun)) job.fail(*refusal);
      }
      Taken& job = *part->of;
      std::optional<Error> error;
      if (!job.stop.stop_requested()) error = do_part(*part, arena);
      bool is_last = false;
      {
        const std::lock_guard lock(mutex);
        if (error) job.fail(std::move(*error));
        if (!job.failure) {
          const double seconds = seconds_between(part->begun, ServiceClock::now());
          mean_seconds += (mean_seconds > 0 ? kNewestShare : 1) * (seconds - mean_seconds);
        }
        is_last = finish(job, 1);
      }
      if (is_last) tell(job);
      {
        const std::lock_guard lock(mutex);
        running.erase(part);
      }
      changed.notify_all();
    }
  }

  static std::optional<Error> do_part(const Part& part, tbb::task_arena& arena) {
    try {
      const Result<void> done = arena.execute([&] {
        return part.of->job.work(part.index, *part.of->generation, part.of->stop.get_token());
      });
      if (done) return std::nullopt;
      return done.error();
    } catch (const std::exception& error) {
      return Error{ErrorCode::internal, error.what()};
    }
  }

  /// Stop what has become useless, and notice what hangs.
  void look_after(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      std::this_thread::sleep_for(kLookInterval);
      const auto now = ServiceClock::now();
      drop_waiting([&](const Taken& job) { return job.overtaken(now); });
      const std::lock_guard lock(mutex);
      is_stuck = false;
      for (const Part& part : running) {
        if (part.of->num_left == 0) continue;  // being answered
        if (const std::optional<Refusal> refusal = part.of->overtaken(now)) part.of->fail(*refusal);
        is_stuck = is_stuck || now - part.begun > kStuckAfter;
      }
    }
  }

  const ServiceOptions options;
  int num_cores = 1;
  mutable std::mutex mutex;
  std::condition_variable changed;
  std::shared_ptr<const LibraryGeneration> generation;
  std::deque<Part> waiting;
  std::list<Part> running;
  std::size_t num_bytes = 0;
  double mean_seconds = 0;      ///< that a part takes; 0: none was done yet
  std::size_t num_telling = 0;  ///< jobs that were dropped and are being answered
  bool is_closed = false, is_stuck = false;
  std::vector<std::jthread> workers;
  std::jthread watch;  // last: it ends first
};

Result<void> validate(const ServiceOptions& options) {
  return engine::check_ranges({
      {options.max_waiting >= 1 && options.max_waiting <= 100'000, "waiting requests",
       "1 to 100000", static_cast<double>(options.max_waiting)},
      {options.max_waiting_bytes >= 1, "bytes of requests", "at least 1",
       static_cast<double>(options.max_waiting_bytes)},
      {options.num_parallel <= 1024, "scenes at a time", "0 to 1024",
       static_cast<double>(options.num_parallel)},
  });
}

RecognitionService::RecognitionService(const ServiceOptions& options,
                                       std::shared_ptr<const LibraryGeneration> first)
    : state_(std::make_unique<State>(options, std::move(first))) {}
RecognitionService::~RecognitionService() = default;

void RecognitionService::submit(ServiceJob job, Done done) {
  const std::size_t num_parts = job.num_parts;
  if (num_parts > state_->options.max_waiting) {
    return done(Error{ErrorCode::usage, fmt::format("expected at most {} scenes in a request, as "
                                                    "many as may wait, found {}",
                                                    state_->options.max_waiting, num_parts)});
  }
  auto taken = std::make_shared<Taken>(
      Taken{std::move(job), std::move(done), nullptr, ServiceClock::now(), {}, num_parts});
  std::optional<Refusal> refusal = taken->overtaken(taken->since);
  {
    const std::lock_guard lock(state_->mutex);
    if (state_->is_closed) {
      refusal = Refusal::closed;
    } else if (state_->is_full(num_parts, taken->job.num_bytes) ||
               (!refusal && state_->would_be_late(*taken))) {
      refusal = Refusal::full;
    }
    if (!refusal) {
      taken->generation = state_->generation;
      state_->num_bytes += taken->job.num_bytes;
      for (std::size_t i = 0; i < num_parts; ++i) state_->waiting.push_back({taken, i});
    }
  }
  if (refusal) return taken->done(*refusal);
  state_->changed.notify_all();
}

bool RecognitionService::is_full(std::size_t num_bytes) const {
  const std::lock_guard lock(state_->mutex);
  return state_->is_full(1, num_bytes);
}

void RecognitionService::publish(std::shared_ptr<const LibraryGeneration> next) {
  const std::lock_guard lock(state_->mutex);
  state_->generation.swap(next);  // the old one goes after the lock, if nobody holds it
}

std::shared_ptr<const LibraryGeneration> RecognitionService::generation() const {
  const std::lock_guard lock(state_->mutex);
  return state_->generation;
}

bool RecognitionService::drain(ServiceClock::time_point deadline) {
  std::unique_lock lock(state_->mutex);
  state_->is_closed = true;
  state_->changed.notify_all();
  const auto is_idle = [&] {
    return state_->waiting.empty() && state_->running.empty() && state_->num_telling == 0;
  };
  const bool all = state_->changed.wait_until(lock, deadline, is_idle);
  if (!all) {
    lock.unlock();
    state_->close(Refusal::closed);
    lock.lock();
    // What was told to stop does so at the end of its stage.
    state_->changed.wait(lock, is_idle);
  }
  return all;
}

ServiceState RecognitionService::state() const {
  const std::lock_guard lock(state_->mutex);
  return {state_->waiting.size(), state_->running.size(), state_->num_bytes, state_->is_stuck};
}

}  // namespace trivet

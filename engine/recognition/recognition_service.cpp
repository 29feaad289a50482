#include "engine/recognition/recognition_service.hpp"

#include <fmt/format.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <list>
#include <mutex>
#include <new>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "engine/common/check_range.hpp"
#include "storage/common/stop.hpp"

namespace trivet {
namespace {

using Done = std::function<void(ServiceOutcome)>;
using Failure = std::variant<Refusal, Error>;

/// Intervals of the service: between inspections of the jobs, maximum time of a part, and maximum
/// time to stop after a stop request.
constexpr std::chrono::milliseconds kWatchInterval{20};
constexpr std::chrono::seconds kStuckAfter{120}, kUnresponsiveAfter{10};
/// Weight of the newest part in the mean time per part.
constexpr double kNewestShare = 0.1;
/// Retries of an answer for lack of memory, since other jobs release theirs.
constexpr int kMostTries = 100;
constexpr std::chrono::milliseconds kRetryInterval{10};

double seconds_between(ServiceClock::time_point from, ServiceClock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

/// A job accepted by the service. The service's mutex guards its mutable members. The job and the
/// memory that it holds live as long as it waits, runs or is being answered.
struct AcceptedJob {
  ~AcceptedJob() { let_go(); }

  ServiceJob job;
  Done done;
  std::shared_ptr<const LibraryGeneration> generation;
  ServiceClock::time_point since, begun{}, stopped{};
  std::size_t num_waiting = 0, num_running = 0;  ///< parts
  std::size_t num_undone = 0;                    ///< parts whose work is not finished
  /// Counter of the service, once the job is accepted.
  std::atomic<std::size_t>* num_bytes_held = nullptr;
  bool is_answered = false;  ///< answered, or being answered by the thread that set this
  std::optional<Failure> failure{};
  std::stop_source stop{};

  /// Returns whether the caller must give the answer because nobody has before.
  bool fail(Failure why) {
    if (std::exchange(is_answered, true)) return false;
    failure = std::move(why);
    stopped = ServiceClock::now();
    stop.request_stop();
    return true;
  }
  /// Reason why an answer has become useless.
  std::optional<Refusal> refusal_at(ServiceClock::time_point now) const noexcept {
    if (now >= job.deadline) return Refusal::too_late;
    if (job.is_gone && job.is_gone()) return Refusal::gone;
    return std::nullopt;
  }
  /// Release the memory of the job, once no part needs it.
  void let_go() {
    job.work = {};
    job.conclude = {};
    if (num_bytes_held) *std::exchange(num_bytes_held, nullptr) -= job.num_bytes;
  }
  ServiceAnswer times() const {
    return {generation, seconds_between(since, begun), seconds_between(begun, ServiceClock::now())};
  }
};
using JobPtr = std::shared_ptr<AcceptedJob>;

/// State of a worker; without a job it is idle.
struct Worker {
  JobPtr of{};
  ServiceClock::time_point begun{};

  bool is_busy() const { return of != nullptr; }
  /// Whether the worker continues despite a stop request.
  bool is_unresponsive(ServiceClock::time_point now) const {
    return of && of->failure && now - of->stopped > kUnresponsiveAfter;
  }
  bool is_stuck(ServiceClock::time_point now) const {
    return of && (now - begun > kStuckAfter || is_unresponsive(now));
  }
};

/// Answer the caller. If the callback throws, it has not answered yet.
void answer(AcceptedJob& job) noexcept {
  for (int i = 0; i < kMostTries; ++i) {
    try {
      if (job.failure) {
        std::visit([&](const auto& why) { job.done(why); }, *job.failure);
      } else {
        job.done(job.times());
      }
      return;
    } catch (...) {
      job.failure = Refusal::no_memory;
      std::this_thread::sleep_for(kRetryInterval);
    }
  }
}

/// The result of `work`, with exceptions converted to errors.
template <class Work>
std::optional<Failure> failure_of(const Work& work) noexcept {
  try {
    try {
      const Result<void> done = work();
      if (done) return std::nullopt;
      if (done.error().code == ErrorCode::no_memory) return Refusal::no_memory;
      return done.error();
    } catch (const Stopped&) {
      return Refusal::gone;  // already answered
    } catch (const std::bad_alloc&) {
      return Refusal::no_memory;
    } catch (const std::exception& error) {
      return Error{ErrorCode::internal, error.what()};
    }
  } catch (...) {  // no memory for the error message
    return Refusal::no_memory;
  }
}

}  // namespace

struct RecognitionService::State {
  State(const ServiceOptions& service_options, std::shared_ptr<const LibraryGeneration> first)
      : options(service_options),
        num_cores(tbb::this_task_arena::max_concurrency()),
        generation(std::move(first)),
        workers(options.num_parallel > 0 ? options.num_parallel
                                         : static_cast<std::size_t>(num_cores)) {
    for (Worker& worker : workers) threads.emplace_back([this, &worker] { work(worker); });
    watch = std::jthread([this](const std::stop_token& stop) { watch_jobs(stop); });
  }

  ~State() {
    close(Refusal::closed);
    threads.clear();  // joins all threads
  }

  bool is_full(std::size_t num_parts, std::size_t num_more) const {
    return num_waiting + num_parts > options.max_waiting ||
           num_bytes + num_more > options.max_waiting_bytes;
  }

  template <class Is>
  std::size_t num_workers(const Is& is) const {
    return static_cast<std::size_t>(std::ranges::count_if(workers, is));
  }

  bool is_idle() const {
    return waiting.empty() && num_ending == 0 && num_workers(&Worker::is_busy) == 0;
  }

  /// Whether a part may start in addition to the running parts.
  bool fits(const AcceptedJob& job) const {
    return num_working_bytes + job.job.part_bytes <= options.max_working_bytes;
  }

  /// Whether a job would be answered after its deadline if the waiting parts take as long as recent
  /// ones. Under overload, work that misses its deadline is wasted, and all work would miss it.
  /// This never refuses a job while a worker is idle; otherwise a mean that is too long would
  /// refuse all jobs and never change.
  bool would_be_late(const AcceptedJob& job) const {
    if (waiting.empty() && num_workers(&Worker::is_busy) < workers.size()) return false;
    const auto now = ServiceClock::now();
    const std::size_t num_hearing =
        num_workers([&](const Worker& worker) { return !worker.is_unresponsive(now); });
    if (num_hearing == 0) return true;
    const auto num_turns =
        static_cast<double>(num_waiting + job.num_waiting) / static_cast<double>(num_hearing);
    return mean_seconds * (num_turns + 0.5) > seconds_between(job.since, job.job.deadline);
  }

  /// Accept no more jobs; refuse the waiting and the running ones.
  void close(Refusal why) {
    {
      const std::lock_guard lock(mutex);
      is_closed = true;
    }
    refuse([&](const AcceptedJob&) { return std::optional(why); });
    changed.notify_all();
  }

  /// Start no further part of a job. Pre: locked.
  void forget_waiting(const JobPtr& job) {
    if (job->num_waiting > 0) waiting.remove(job);
    num_waiting -= std::exchange(job->num_waiting, 0);
  }

  /// Answer every waiting or running job that has a reason to be refused. Allocates nothing, since
  /// lack of memory must not end its thread.
  template <class Why>
  void refuse(const Why& why) {
    std::list<JobPtr> refused;
    {
      const std::lock_guard lock(mutex);
      for (auto at = waiting.begin(); at != waiting.end();) {
        const auto job = at++;
        const std::optional<Refusal> reason = why(std::as_const(**job));
        if (!reason || !(*job)->fail(*reason)) continue;
        refused.splice(refused.end(), waiting, job);
        num_waiting -= std::exchange((*job)->num_waiting, 0);
      }
      num_ending += refused.size();
    }
    for (JobPtr& job : refused) leave(std::move(job), true);
    while (JobPtr job = refuse_running(why)) leave(std::move(job), true);
  }

  /// Returns a job that must be answered; null if there is none.
  template <class Why>
  JobPtr refuse_running(const Why& why) {
    const std::lock_guard lock(mutex);
    for (const Worker& worker : workers) {
      if (!worker.of || worker.of->is_answered) continue;
      const std::optional<Refusal> reason = why(std::as_const(*worker.of));
      if (!reason || !worker.of->fail(*reason)) continue;
      forget_waiting(worker.of);
      ++num_ending;
      return worker.of;
    }
    return nullptr;
  }

  /// Release a job that was counted as ending. If the caller is responsible for its answer, give it
  /// first.
  void leave(JobPtr job, bool is_ours) {
    if (is_ours) {
      bool is_finished = false;
      {
        const std::lock_guard lock(mutex);
        is_finished = job->num_running == 0;
      }
      if (is_finished) job->let_go();  // free the memory before answering
      answer(*job);
    }
    job.reset();
    {
      const std::lock_guard lock(mutex);
      --num_ending;
    }
    changed.notify_all();
  }

  void work(Worker& worker) {
    if (options.on_thread_start) options.on_thread_start();
    // Each worker may use all cores, so that a scene alone uses all of them and many scenes share
    // them.
    tbb::task_arena arena(num_cores);
    while (const std::optional<std::size_t> part = begin(worker)) {
      AcceptedJob* const job = worker.of.get();
      std::optional<Failure> failure;
      if (const std::optional<Refusal> refusal = job->refusal_at(worker.begun)) {
        failure = *refusal;
      } else {
        failure = failure_of([&] {
          return arena.execute([&] {
            const std::stop_token stop = job->stop.get_token();
            const StopScope scope(&stop);
            return job->job.work(*part, *job->generation, stop);
          });
        });
      }
      if (is_last_and_good(worker, failure) && job->job.conclude) {
        failure = failure_of([&]() -> Result<void> {
          job->job.conclude(job->times());
          return {};
        });
      }
      end(worker, std::move(failure));
    }
  }

  /// Start the next part. Absent: the service is ending.
  std::optional<std::size_t> begin(Worker& worker) {
    std::unique_lock lock(mutex);
    changed.wait(lock, [&] { return waiting.empty() ? is_closed : fits(*waiting.front()); });
    if (waiting.empty()) return std::nullopt;
    worker.of = waiting.front();
    worker.begun = ServiceClock::now();
    AcceptedJob& job = *worker.of;
    if (job.begun == ServiceClock::time_point{}) job.begun = worker.begun;
    num_working_bytes += job.job.part_bytes;
    --num_waiting;
    if (--job.num_waiting == 0) waiting.pop_front();
    ++job.num_running;
    return job.job.num_parts - job.num_waiting - 1;
  }

  /// Record that the work of a part is finished or has failed. Returns whether only the conclusion
  /// remains for a job that is not answered yet.
  bool is_last_and_good(const Worker& worker, const std::optional<Failure>& failure) {
    const std::lock_guard lock(mutex);
    AcceptedJob& job = *worker.of;
    if (failure || job.is_answered) return false;
    const double seconds = seconds_between(worker.begun, ServiceClock::now());
    mean_seconds += (mean_seconds > 0 ? kNewestShare : 1) * (seconds - mean_seconds);
    return --job.num_undone == 0;
  }

  void end(Worker& worker, std::optional<Failure> failure) {
    JobPtr job;
    bool is_ours = false;
    {
      const std::lock_guard lock(mutex);
      job.swap(worker.of);
      num_working_bytes -= job->job.part_bytes;
      --job->num_running;
      if (failure) {
        is_ours = job->fail(std::move(*failure));
        forget_waiting(job);
      } else if (job->num_waiting + job->num_running == 0) {
        is_ours = !std::exchange(job->is_answered, true);
      }
      ++num_ending;
    }
    leave(std::move(job), is_ours);
  }

  /// Answer jobs in time, and detect parts that hang.
  void watch_jobs(const std::stop_token& stop) {
    if (options.on_thread_start) options.on_thread_start();
    while (!stop.stop_requested()) {
      std::this_thread::sleep_for(kWatchInterval);
      const auto now = ServiceClock::now();
      refuse([&](const AcceptedJob& job) { return job.refusal_at(now); });
      const std::lock_guard lock(mutex);
      is_stuck = std::ranges::any_of(workers, [&](const Worker& w) { return w.is_stuck(now); });
    }
  }

  const ServiceOptions options;
  const int num_cores;
  mutable std::mutex mutex;
  std::condition_variable changed;
  std::shared_ptr<const LibraryGeneration> generation;
  std::list<JobPtr> waiting;  ///< unanswered jobs with parts that have not started
  std::vector<Worker> workers;
  std::size_t num_waiting = 0, num_working_bytes = 0;
  std::atomic<std::size_t> num_bytes{0};
  double mean_seconds = 0;     ///< mean time per part; 0: none is finished yet
  std::size_t num_ending = 0;  ///< jobs being answered or released
  bool is_closed = false, is_stuck = false;
  std::vector<std::jthread> threads;
  std::jthread watch;  // last member, so that it ends first
};

Result<void> validate(const ServiceOptions& options) {
  return engine::check_ranges({
      {options.max_waiting >= 1 && options.max_waiting <= 100'000, "waiting requests",
       "1 to 100000", static_cast<double>(options.max_waiting)},
      {options.max_waiting_bytes >= 1, "bytes of requests", "at least 1",
       static_cast<double>(options.max_waiting_bytes)},
      {options.max_working_bytes >= 1, "bytes of scenes at work", "at least 1",
       static_cast<double>(options.max_working_bytes)},
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
  auto accepted = std::make_shared<AcceptedJob>();
  accepted->job = std::move(job);
  accepted->done = std::move(done);
  accepted->since = ServiceClock::now();
  accepted->num_waiting = accepted->num_undone = num_parts;
  std::list<JobPtr> last{accepted};
  std::optional<Refusal> refusal = accepted->refusal_at(accepted->since);
  {
    const std::lock_guard lock(state_->mutex);
    if (state_->is_closed) {
      refusal = Refusal::closed;
    } else if (accepted->job.part_bytes > state_->options.max_working_bytes) {
      refusal = Refusal::too_large;
    } else if (state_->is_full(num_parts, accepted->job.num_bytes) ||
               (!refusal && state_->would_be_late(*accepted))) {
      refusal = Refusal::full;
    }
    if (refusal) {
      (void)accepted->fail(*refusal);
    } else {
      accepted->generation = state_->generation;
      accepted->num_bytes_held = &state_->num_bytes;
      state_->num_bytes += accepted->job.num_bytes;
      state_->num_waiting += num_parts;
      state_->waiting.splice(state_->waiting.end(), last);
    }
  }
  if (refusal) return answer(*accepted);
  state_->changed.notify_all();
}

bool RecognitionService::is_full(std::size_t num_bytes) const {
  const std::lock_guard lock(state_->mutex);
  return state_->is_full(1, num_bytes);
}

void RecognitionService::publish(std::shared_ptr<const LibraryGeneration> next) {
  const std::lock_guard lock(state_->mutex);
  state_->generation.swap(next);  // if unused, the old generation is released after the lock
}

std::shared_ptr<const LibraryGeneration> RecognitionService::generation() const {
  const std::lock_guard lock(state_->mutex);
  return state_->generation;
}

bool RecognitionService::drain(ServiceClock::time_point deadline) {
  std::unique_lock lock(state_->mutex);
  state_->is_closed = true;
  state_->changed.notify_all();
  const auto is_idle = [&] { return state_->is_idle(); };
  const bool all = state_->changed.wait_until(lock, deadline, is_idle);
  if (!all) {
    lock.unlock();
    state_->close(Refusal::closed);
    lock.lock();
    state_->changed.wait(lock, is_idle);
  }
  return all;
}

ServiceState RecognitionService::state() const {
  const std::lock_guard lock(state_->mutex);
  return {state_->num_waiting, state_->num_workers(&Worker::is_busy), state_->num_bytes,
          state_->num_working_bytes, state_->is_stuck};
}

}  // namespace trivet

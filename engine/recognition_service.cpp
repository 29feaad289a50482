#include "engine/recognition_service.hpp"

#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <exception>
#include <list>
#include <mutex>
#include <stop_token>
#include <thread>
#include <vector>

#include "engine/check_range.hpp"

namespace trivet {
namespace {

using Done = std::function<void(ServiceOutcome)>;

/// How often running jobs are looked at, and how long none should take.
constexpr std::chrono::milliseconds kLookInterval{20};
constexpr std::chrono::seconds kStuckAfter{120};

double seconds_between(ServiceClock::time_point from, ServiceClock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

struct Waiting {
  ServiceJob job;
  Done done;
  ServiceClock::time_point since;
};

struct Running {
  ServiceClock::time_point since, deadline;
  std::function<bool()> is_gone;
  std::stop_source stop;
  std::optional<Refusal> refusal;  ///< why it was stopped
};

std::optional<Refusal> overtaken(ServiceClock::time_point now, ServiceClock::time_point deadline,
                                 const std::function<bool()>& is_gone) {
  if (now >= deadline) return Refusal::too_late;
  if (is_gone && is_gone()) return Refusal::gone;
  return std::nullopt;
}

}  // namespace

struct RecognitionService::State {
  State(const ServiceOptions& service_options, std::shared_ptr<const LibraryGeneration> first)
      : options(service_options), generation(std::move(first)) {
    const auto num_cores = static_cast<unsigned>(tbb::this_task_arena::max_concurrency());
    const unsigned num_parallel =
        options.num_parallel > 0 ? options.num_parallel : std::max(1U, num_cores);
    threads_each = static_cast<int>(std::max(1U, num_cores / num_parallel));
    for (unsigned i = 0; i < num_parallel; ++i) workers.emplace_back([this] { work(); });
    watch = std::jthread([this](const std::stop_token& stop) { look_after(stop); });
  }

  ~State() {
    {
      const std::lock_guard lock(mutex);
      is_closed = true;
      for (Running& job : running) stop_running(job, Refusal::closed);
    }
    refuse_waiting(Refusal::closed);
    changed.notify_all();
    workers.clear();  // joins
  }

  static void stop_running(Running& job, Refusal refusal) {
    if (!job.refusal) job.refusal = refusal;
    job.stop.request_stop();
  }

  void refuse_waiting(Refusal refusal) {
    std::deque<Waiting> refused;
    {
      const std::lock_guard lock(mutex);
      refused.swap(waiting);
      for (const Waiting& job : refused) num_bytes -= job.job.num_bytes;
    }
    for (Waiting& job : refused) job.done(refusal);
  }

  void work() {
    tbb::task_arena arena(threads_each);
    for (;;) {
      Waiting next;
      std::list<Running>::iterator here;
      {
        std::unique_lock lock(mutex);
        changed.wait(lock, [&] { return is_closed || !waiting.empty(); });
        if (waiting.empty()) return;
        next = std::move(waiting.front());
        waiting.pop_front();
        here = running.insert(
            running.end(),
            Running{ServiceClock::now(), next.job.deadline, next.job.is_gone, {}, {}});
      }
      ServiceOutcome outcome = answer(next, *here, arena);
      next.job.read = {};  // the memory goes before the answer
      {
        const std::lock_guard lock(mutex);
        if (here->refusal) outcome = *here->refusal;
        num_bytes -= next.job.num_bytes;
      }
      next.done(std::move(outcome));
      {
        const std::lock_guard lock(mutex);
        running.erase(here);
      }
      changed.notify_all();
    }
  }

  ServiceOutcome answer(const Waiting& next, Running& here, tbb::task_arena& arena) {
    if (const std::optional<Refusal> refusal = overtaken(here.since, here.deadline, here.is_gone)) {
      return *refusal;
    }
    ServiceAnswer out;
    {
      const std::lock_guard lock(mutex);
      out.generation = generation;
    }
    out.queue_seconds = seconds_between(next.since, here.since);
    try {
      for (std::size_t s = 0; s < next.job.inputs.size(); ++s) {
        Result<SceneResult> result = arena.execute([&]() -> Result<SceneResult> {
          const Result<Cloud> scene = next.job.read(s);
          if (!scene) return scene.error();
          return recognise(out.generation->recogniser, *scene, next.job.inputs[s], next.job.options,
                           here.stop.get_token());
        });
        if (!result) return result.error();
        out.results.push_back(std::move(*result));
      }
    } catch (const std::exception& error) {
      return Error{ErrorCode::internal, error.what()};
    }
    out.work_seconds = seconds_between(here.since, ServiceClock::now());
    return out;
  }

  /// Stop what has become useless, and notice what hangs.
  void look_after(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      std::this_thread::sleep_for(kLookInterval);
      const auto now = ServiceClock::now();
      const std::lock_guard lock(mutex);
      bool stuck = false;
      for (Running& job : running) {
        if (const std::optional<Refusal> refusal = overtaken(now, job.deadline, job.is_gone))
          stop_running(job, *refusal);
        stuck = stuck || now - job.since > kStuckAfter;
      }
      is_stuck = stuck;
    }
  }

  const ServiceOptions options;
  int threads_each = 1;
  mutable std::mutex mutex;
  std::condition_variable changed;
  std::shared_ptr<const LibraryGeneration> generation;
  std::deque<Waiting> waiting;
  std::list<Running> running;
  std::size_t num_bytes = 0;
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

void RecognitionService::submit(ServiceJob job, std::function<void(ServiceOutcome)> done) {
  const auto now = ServiceClock::now();
  std::optional<Refusal> refusal = overtaken(now, job.deadline, job.is_gone);
  {
    const std::lock_guard lock(state_->mutex);
    if (state_->is_closed) {
      refusal = Refusal::closed;
    } else if (state_->waiting.size() >= state_->options.max_waiting ||
               state_->num_bytes + job.num_bytes > state_->options.max_waiting_bytes) {
      refusal = Refusal::full;
    }
    if (!refusal) {
      state_->num_bytes += job.num_bytes;
      state_->waiting.push_back({std::move(job), done, now});
    }
  }
  if (refusal) return done(*refusal);
  state_->changed.notify_one();
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
  bool all = false;
  {
    std::unique_lock lock(state_->mutex);
    state_->is_closed = true;
    state_->changed.notify_all();
    all = state_->changed.wait_until(
        lock, deadline, [&] { return state_->waiting.empty() && state_->running.empty(); });
    if (!all) {
      for (Running& job : state_->running) State::stop_running(job, Refusal::closed);
    }
  }
  state_->refuse_waiting(Refusal::closed);
  // What was told to stop does so at the end of its stage.
  std::unique_lock lock(state_->mutex);
  state_->changed.wait(lock, [&] { return state_->running.empty(); });
  return all;
}

ServiceState RecognitionService::state() const {
  const std::lock_guard lock(state_->mutex);
  return {state_->waiting.size(), state_->running.size(), state_->num_bytes, state_->is_stuck};
}

}  // namespace trivet

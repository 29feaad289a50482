#include "apps/mpi/ranks.hpp"

#include <fmt/format.h>
#include <mpi.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>

namespace trivet::apps::mpi {
namespace {

/// Kinds of messages.
enum Tag : int {
  kAsk,       // to rank 0: request for a job
  kJob,       // from rank 0: '+' and the job; empty: no more jobs
  kOutcome,   // to rank 0: result of a job
  kEnd,       // to rank 0: result of the rank's work
  kAllEnded,  // from rank 0: all have ended
};

constexpr std::chrono::milliseconds kPause{1};
/// How long a stopped rank waits for other ranks, which may have been killed.
constexpr std::chrono::seconds kPatience{2};

void send(int to, Tag tag, const std::string& bytes) {
  MPI_Send(bytes.data(), static_cast<int>(bytes.size()), MPI_BYTE, to, tag, MPI_COMM_WORLD);
}

struct Message {
  int from = 0, tag = 0;
  std::string bytes;
};

/// A received message, if any. A blocking MPI call would occupy a core.
std::optional<Message> receive() {
  int is_there = 0;
  MPI_Status status;
  MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &is_there, &status);
  if (is_there == 0) return std::nullopt;
  int size = 0;
  MPI_Get_count(&status, MPI_BYTE, &size);
  Message message{status.MPI_SOURCE, status.MPI_TAG,
                  std::string(static_cast<std::size_t>(size), ' ')};
  MPI_Recv(message.bytes.data(), size, MPI_BYTE, message.from, message.tag, MPI_COMM_WORLD,
           MPI_STATUS_IGNORE);
  return message;
}

std::string encode(const Result<void>& ended) {
  if (ended) return "";
  return static_cast<char>('0' + static_cast<int>(ended.error().code)) + ended.error().message;
}

Result<void> decode(const std::string& bytes) {
  if (bytes.empty()) return {};
  return Error{static_cast<ErrorCode>(bytes[0] - '0'), bytes.substr(1)};
}

/// Exchanges messages between the worker thread and the thread that may call MPI.
class Exchange {
 public:
  // called by the worker thread
  std::optional<std::string> ask() {
    std::unique_lock lock(mutex_);
    asked_ = true;
    answered_.wait(lock, [&] { return answer_.has_value(); });
    std::string answer = *std::exchange(answer_, std::nullopt);
    if (answer.empty()) return std::nullopt;
    return answer.substr(1);
  }
  void report(std::string outcome) {
    const std::lock_guard lock(mutex_);
    outcomes_.push_back(std::move(outcome));
  }

  // called by the thread that calls MPI
  bool pop_request() {
    const std::lock_guard lock(mutex_);
    return std::exchange(asked_, false);
  }
  void answer(std::string job) {
    const std::lock_guard lock(mutex_);
    answer_ = std::move(job);
    answered_.notify_one();
  }
  std::deque<std::string> pop_outcomes() {
    const std::lock_guard lock(mutex_);
    return std::exchange(outcomes_, {});
  }

 private:
  std::mutex mutex_;
  std::condition_variable answered_;
  bool asked_ = false;
  std::optional<std::string> answer_;
  std::deque<std::string> outcomes_;
};

/// The work of a rank in a separate thread.
class Work {
 public:
  Work(const std::function<Result<void>(const Worker&)>& work, Worker worker)
      : thread_([this, work, worker = std::move(worker)] {
          result_ = work(worker);
          ended_ = true;
        }) {}
  bool ended() const noexcept { return ended_; }
  const Result<void>& result() const noexcept { return result_; }  ///< pre: ended

 private:
  Result<void> result_;
  std::atomic<bool> ended_{false};
  std::jthread thread_;  // last member: joined first
};

/// Measures the time since a stop was requested.
class Patience {
 public:
  explicit Patience(std::stop_token stop) : stop_(std::move(stop)) {}
  bool is_exhausted() {
    if (!stop_.stop_requested()) return false;
    const auto now = std::chrono::steady_clock::now();
    if (!asked_) since_ = now;
    asked_ = true;
    return now - since_ > kPatience;
  }

 private:
  std::stop_token stop_;
  bool asked_ = false;
  std::chrono::steady_clock::time_point since_{};
};

Error stopped() { return {ErrorCode::resumable, "stopped; the same command goes on"}; }

std::string next_of(const JobBook& book) {
  const std::optional<std::string> job = book.next();
  return job ? "+" + *job : "";
}

Result<void> lead(const Ranks& ranks, const JobBook& book,
                  const std::function<Result<void>(const Worker&)>& do_work,
                  const std::stop_token& stop) {
  Exchange own;
  const Work work(do_work, {[&] { return own.ask(); },
                            [&](std::string outcome) { own.report(std::move(outcome)); }});
  Patience patience(stop);
  Result<void> first;
  int num_ended = 1;  // including this rank
  while (true) {
    const bool own_ended = work.ended();  // read before its last outcomes are received
    while (const std::optional<Message> message = receive()) {
      if (message->tag == kAsk) send(message->from, kJob, next_of(book));
      if (message->tag == kOutcome) book.done(message->bytes);
      if (message->tag != kEnd) continue;
      ++num_ended;
      if (const Result<void> ended = decode(message->bytes); !ended && first)
        first = Error{ended.error().code,
                      fmt::format("rank {}: {}", message->from, ended.error().message)};
    }
    if (own.pop_request()) own.answer(next_of(book));
    for (std::string& outcome : own.pop_outcomes()) book.done(std::move(outcome));
    if (own_ended && (num_ended == ranks.size() || patience.is_exhausted())) break;
    std::this_thread::sleep_for(kPause);
  }
  if (num_ended < ranks.size()) return stopped();
  for (int rank = 1; rank < ranks.size(); ++rank) send(rank, kAllEnded, "");
  return work.result() ? first : work.result();
}

Result<void> follow(const std::function<Result<void>(const Worker&)>& do_work,
                    const std::stop_token& stop) {
  Exchange own;
  const Work work(do_work, {[&] { return own.ask(); },
                            [&](std::string outcome) { own.report(std::move(outcome)); }});
  Patience patience(stop);
  bool reported_end = false;
  while (true) {
    const bool ended = work.ended();
    while (std::optional<Message> message = receive()) {
      if (message->tag == kJob) own.answer(std::move(message->bytes));
      if (message->tag == kAllEnded) return work.result();
    }
    if (own.pop_request()) {
      if (stop.stop_requested()) {
        own.answer("");  // rank 0 may be dead
      } else {
        send(0, kAsk, "");
      }
    }
    for (const std::string& outcome : own.pop_outcomes()) send(0, kOutcome, outcome);
    if (ended && !reported_end) {
      send(0, kEnd, encode(work.result()));
      reported_end = true;
    }
    if (patience.is_exhausted()) {
      if (ended) return stopped();
      own.answer("");  // the awaited message will not come
    }
    std::this_thread::sleep_for(kPause);
  }
}

}  // namespace

Ranks::Ranks(int& argc, char**& argv) {
  int provided = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
}

void Ranks::end_all(int exit_code) const { MPI_Abort(MPI_COMM_WORLD, exit_code); }

Ranks::~Ranks() { MPI_Finalize(); }

Result<void> share_jobs(const Ranks& ranks, const JobBook& book,
                        const std::function<Result<void>(const Worker&)>& work,
                        const std::stop_token& stop) {
  return ranks.is_first() ? lead(ranks, book, work, stop) : follow(work, stop);
}

}  // namespace trivet::apps::mpi

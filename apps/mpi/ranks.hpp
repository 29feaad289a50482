/// The processes of an MPI program, and jobs that they share.
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <string>

#include "storage/common/result.hpp"

namespace trivet::apps::mpi {

/// Initializes MPI and ends it. Only the thread that made it may call it, or MPI.
class Ranks {
 public:
  Ranks(int& argc, char**& argv);
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;
  ~Ranks();

  int rank() const noexcept { return rank_; }
  int size() const noexcept { return size_; }
  bool is_first() const noexcept { return rank_ == 0; }
  /// To be called at the end of a rank that failed: ends all others, which may wait for it.
  void end_all(int exit_code) const;

 private:
  int rank_ = 0, size_ = 1;
};

/// The jobs, as rank 0 knows them; called on rank 0 alone, by one thread at a time.
struct JobBook {
  std::function<std::optional<std::string>()> next;  ///< the next job; nothing: there are no more
  std::function<void(std::string outcome)> done;
};

/// What a rank works with: `next` waits for a job, `done` tells of one. From any thread, each by one
/// at a time.
struct Worker {
  std::function<std::optional<std::string>()> next;
  std::function<void(std::string outcome)> done;
};

/// Work on the jobs of rank 0's book until there are no more, in all ranks at once: each asks rank 0
/// for the next when it is ready for it, so that none waits for another (no collective calls).
/// Returns when all ranks have ended.
///
/// work  runs in a thread of its own; its error is that of its rank
/// stop  ends the waiting for ranks that may be dead
/// Errors: on rank 0 the first of any rank; elsewhere this rank's own; resumable when stopped.
Result<void> share_jobs(const Ranks& ranks, const JobBook& book,
                        const std::function<Result<void>(const Worker&)>& work,
                        const std::stop_token& stop);

}  // namespace trivet::apps::mpi

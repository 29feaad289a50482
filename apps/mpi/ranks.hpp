/// The processes of an MPI program, and jobs distributed over them.
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <string>

#include "storage/common/result.hpp"

namespace trivet::apps::mpi {

/// Initializes and finalizes MPI. Only the thread that constructed it may call it, or MPI.
class Ranks {
 public:
  Ranks(int& argc, char**& argv);
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;
  ~Ranks();

  int rank() const noexcept { return rank_; }
  int size() const noexcept { return size_; }
  bool is_first() const noexcept { return rank_ == 0; }
  /// Aborts all other ranks, which may wait for this one. Call it at the end of a rank that failed.
  void end_all(int exit_code) const;

 private:
  int rank_ = 0, size_ = 1;
};

/// The jobs, kept by rank 0. Called on rank 0 only, by one thread at a time.
struct JobBook {
  std::function<std::optional<std::string>()> next;  ///< the next job; none: there are no more
  std::function<void(std::string outcome)> done;
};

/// Callbacks of a rank's worker: `next` waits for a job, `done` reports the result of one. From any
/// thread, each by one thread at a time.
struct Worker {
  std::function<std::optional<std::string>()> next;
  std::function<void(std::string outcome)> done;
};

/// Processes the jobs of rank 0's book in all ranks until there are no more. Each rank requests the
/// next job from rank 0 when it is ready, so that no rank waits for another (no collective calls).
/// Returns when all ranks have ended.
///
/// work  runs in a separate thread; its error is that of its rank
/// stop  ends the wait for ranks that may be dead
/// Errors: on rank 0 the first error of any rank; elsewhere this rank's error; resumable when
/// stopped.
Result<void> share_jobs(const Ranks& ranks, const JobBook& book,
                        const std::function<Result<void>(const Worker&)>& work,
                        const std::stop_token& stop);

}  // namespace trivet::apps::mpi

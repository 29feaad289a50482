/// Limit on the number of threads.
#pragma once

#include <memory>

namespace trivet {

/// Limits the number of threads of everything that runs during its lifetime; 0 means all cores.
class ThreadLimit {
 public:
  explicit ThreadLimit(unsigned num_threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace trivet

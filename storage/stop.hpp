/// Work that is told to stop is left where it looks whether it was.
#pragma once

#include <cstddef>
#include <stop_token>

namespace trivet {

/// What look() throws. No std::exception, as it is no error: who gave the token takes it.
struct Stopped {};

/// What this thread works for until the scope ends. The engine's loops hand it on to the threads
/// that help them, so that no stage has to name it.
class StopScope {
 public:
  /// stop  outlives the scope; null: the work goes on to its end
  explicit StopScope(const std::stop_token* stop) noexcept;
  StopScope(const StopScope&) = delete;
  StopScope& operator=(const StopScope&) = delete;
  ~StopScope();

 private:
  const std::stop_token* const before_;
};

const std::stop_token* current_stop() noexcept;

/// Throws Stopped where the work is to stop. Cheap; a loop that may take 50 ms calls it.
void look();

/// The same from within a loop of short steps: looks at every so many of them.
class LookEvery {
 public:
  explicit LookEvery(std::size_t num_steps) noexcept : num_steps_(num_steps) {}
  void operator()() {
    if (++step_ < num_steps_) return;
    step_ = 0;
    look();
  }

 private:
  std::size_t num_steps_;
  std::size_t step_ = 0;
};

/// For tests: called with each look, from the thread that looks; null: nothing.
void observe_looks(void (*observer)()) noexcept;

}  // namespace trivet

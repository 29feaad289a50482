/// Cooperative cancellation: work ends at the next check after its stop token was requested.
#pragma once

#include <cstddef>
#include <stop_token>

namespace trivet {

/// What check_stop() throws. It is no std::exception, since it is no error: the owner of the token
/// catches it.
struct Stopped {};

/// Makes a stop token the one that this thread checks until the scope ends. The engine's parallel
/// loops pass it on to their threads, so that no stage needs it as a parameter.
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

/// The token of the innermost StopScope of this thread; null: none.
const std::stop_token* current_stop() noexcept;

/// Throw Stopped if stop was requested. Costs nanoseconds; a loop that may run for 50 ms calls it.
void check_stop();

/// Calls check_stop() once in every num_steps calls: for loops of short steps.
class StopCheck {
 public:
  explicit StopCheck(std::size_t num_steps) noexcept : num_steps_(num_steps) {}
  void operator()() {
    if (++step_ < num_steps_) return;
    step_ = 0;
    check_stop();
  }

 private:
  std::size_t num_steps_;
  std::size_t step_ = 0;
};

/// For tests: called at each check, on the checking thread; null: nothing is called.
void observe_stop_checks(void (*observer)()) noexcept;

}  // namespace trivet

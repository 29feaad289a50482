/// Cooperative cancellation: work ends at the next check after a stop was requested.
#pragma once

#include <cstddef>
#include <stop_token>

namespace trivet {

/// Thrown by check_stop(). Not a std::exception because it is not an error; the owner of the token
/// catches it.
struct Stopped {};

/// Sets the stop token that this thread checks until the scope ends. The engine's parallel loops
/// pass it on to their threads, so no stage needs it as a parameter.
class StopScope {
 public:
  /// stop  token that outlives the scope; null: the work cannot be stopped
  explicit StopScope(const std::stop_token* stop) noexcept;
  StopScope(const StopScope&) = delete;
  StopScope& operator=(const StopScope&) = delete;
  ~StopScope();

 private:
  const std::stop_token* const before_;
};

/// The token of the innermost StopScope of this thread; null: none.
const std::stop_token* current_stop() noexcept;

/// Throw Stopped if a stop was requested. Costs nanoseconds; every loop that may run for 50 ms
/// calls it.
void check_stop();

/// Calls check_stop() once every num_steps calls, for loops of short steps.
class StopCheck {
 public:
  static constexpr std::size_t kPoints = 1 << 18;  ///< points between two checks: milliseconds

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

/// For tests: sets a function that each check calls on the checking thread; null: none.
void observe_stop_checks(void (*observer)()) noexcept;

}  // namespace trivet

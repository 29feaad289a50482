/// A value that the first caller computes, while concurrent callers help with its loops.
#pragma once

#include <tbb/collaborative_call_once.h>

#include <exception>
#include <memory>
#include <mutex>
#include <optional>

namespace trivet::engine {

/// Thread-safe. A thread that waits in TBB may execute another task that requests the same value;
/// std::call_once would deadlock there. TBB must not see exceptions of the computation either,
/// since it would wait forever for the cancelled task, or crash.
template <class T>
class MadeOnce {
 public:
  /// The value, computed by make() if necessary. If make() throws, for example Stopped at a
  /// deadline, its own caller receives the exception, and other callers compute the value again.
  ///
  /// make  () -> T
  template <class Make>
  const T& get(const Make& make) {
    for (;;) {
      const std::shared_ptr<Attempt> attempt = current();
      bool is_mine = false;
      tbb::collaborative_call_once(attempt->once, [&]() noexcept {
        is_mine = true;
        try {
          attempt->value.emplace(make());
        } catch (...) {
          attempt->fault = std::current_exception();
        }
      });
      if (!attempt->fault) return *attempt->value;
      give_up(attempt);
      if (is_mine) std::rethrow_exception(attempt->fault);
    }
  }

 private:
  struct Attempt {
    tbb::collaborative_once_flag once;
    std::optional<T> value;
    std::exception_ptr fault;
  };

  std::shared_ptr<Attempt> current() {
    const std::lock_guard lock(mutex_);
    if (!attempt_) attempt_ = std::make_shared<Attempt>();
    return attempt_;
  }
  void give_up(const std::shared_ptr<Attempt>& attempt) {
    const std::lock_guard lock(mutex_);
    if (attempt_ == attempt) attempt_.reset();
  }

  std::mutex mutex_;
  std::shared_ptr<Attempt> attempt_;  // kept once it has a value
};

}  // namespace trivet::engine

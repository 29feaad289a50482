/// A value that the first who asks for it makes, while others who ask meanwhile help with its loops.
#pragma once

#include <tbb/collaborative_call_once.h>

#include <exception>
#include <memory>
#include <mutex>
#include <optional>

namespace trivet::engine {

/// Thread-safe. A thread that waits in TBB may take up other work that asks for the same value, which
/// std::call_once would never come back from; and TBB's own must not see what making throws: it would
/// wait for the cancelled task for ever, or crash.
template <class T>
class MadeOnce {
 public:
  /// The value, by make() if it is not there. What that throws, such as Stopped at a deadline, goes to
  /// whose make() it was; another who asks makes it anew.
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
  std::shared_ptr<Attempt> attempt_;  // stays once it has a value
};

}  // namespace trivet::engine

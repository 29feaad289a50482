/// Returns freed memory to the system.
#pragma once

#include <chrono>

namespace trivet::apps::service {

/// The allocator keeps what each thread has freed: as much as its largest scene used, and memory of
/// old libraries. One object lives as long as the process has work, and is called a few times a
/// second.
class MemoryTrim {
 public:
  /// Bounds the memory kept per thread. Call it before other threads start.
  MemoryTrim();

  /// Returns memory when work has ended, and every few seconds while it goes on.
  void trim(bool is_busy);

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now(), last_busy_ = last_;
};

}  // namespace trivet::apps::service

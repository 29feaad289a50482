/// Memory that finished work leaves free goes back to the system.
#pragma once

#include <chrono>

namespace trivet::apps::service {

/// The allocator keeps what each thread has freed, as much as its largest scene took and as old
/// libraries did. One lives as long as the process has work, and is asked a few times a second.
class MemoryTrim {
 public:
  /// Bounds what each thread keeps. Before other threads are.
  MemoryTrim();

  /// Give back when work has ended, and every few seconds while it goes on.
  void trim(bool is_busy);

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now(), last_busy_ = last_;
};

}  // namespace trivet::apps::service

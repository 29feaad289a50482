/// Behavior of an allocation when memory is exhausted: it fails at once, or waits for other work to
/// free memory.
#pragma once

namespace trivet {

/// From now on, failed allocations on this thread are retried for a second, while work on other
/// threads ends and frees memory. For threads that serve clients. Other threads throw
/// std::bad_alloc at once, as usual. There is no retry while another exception unwinds the stack:
/// destructors of JSON documents allocate, and an exception from them would end the process.
void wait_for_memory_on_this_thread() noexcept;

/// While it lives, allocations on this thread fail at once, as on threads that do not wait.
class FailWithoutMemory {
 public:
  FailWithoutMemory() noexcept;
  ~FailWithoutMemory();
  FailWithoutMemory(const FailWithoutMemory&) = delete;
  FailWithoutMemory& operator=(const FailWithoutMemory&) = delete;

 private:
  bool was_patient_;
};

/// While one lives, failed allocations on all threads are retried for a second, if any thread of
/// the process waits for memory. For calls of libraries that start threads of their own, on which a
/// failed allocation would be fatal.
class WaitForMemoryEverywhere {
 public:
  WaitForMemoryEverywhere() noexcept;
  ~WaitForMemoryEverywhere();
  WaitForMemoryEverywhere(const WaitForMemoryEverywhere&) = delete;
  WaitForMemoryEverywhere& operator=(const WaitForMemoryEverywhere&) = delete;
};

}  // namespace trivet

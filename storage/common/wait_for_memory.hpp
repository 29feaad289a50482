/// What an allocation does where memory is missing: it fails at once, or waits for what others give
/// back.
#pragma once

namespace trivet {

/// From now on, allocations that fail on this thread are tried again for a second, while work on
/// others ends and gives memory back. For threads that answer clients. On other threads
/// std::bad_alloc is thrown at once, as ever, but not while another exception unwinds the stack:
/// destructors of JSON documents allocate, and what they throw would end the process.
void wait_for_memory_on_this_thread() noexcept;

/// While it lives, allocations of this thread fail at once, as on threads that do not wait.
class FailWithoutMemory {
 public:
  FailWithoutMemory() noexcept;
  ~FailWithoutMemory();
  FailWithoutMemory(const FailWithoutMemory&) = delete;
  FailWithoutMemory& operator=(const FailWithoutMemory&) = delete;

 private:
  bool was_patient_;
};

/// While one lives, allocations of all threads are tried again for a second, if any thread of the
/// process waits for memory. For calls of libraries that do not survive a failed allocation on a
/// thread of their own.
class WaitForMemoryEverywhere {
 public:
  WaitForMemoryEverywhere() noexcept;
  ~WaitForMemoryEverywhere();
  WaitForMemoryEverywhere(const WaitForMemoryEverywhere&) = delete;
  WaitForMemoryEverywhere& operator=(const WaitForMemoryEverywhere&) = delete;
};

}  // namespace trivet

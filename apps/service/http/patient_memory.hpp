/// Threads that answer clients wait for memory; work on a scan fails for want of it, and gives back
/// what it held.
#pragma once

namespace trivet::apps::service {

/// From now on, allocations that fail on this thread are tried again for a second, while work on
/// others ends and gives memory back. On other threads std::bad_alloc is thrown at once, as ever,
/// but not while another exception unwinds the stack: destructors of JSON documents allocate, and
/// what they throw would end the process.
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

}  // namespace trivet::apps::service

/// Who answers for others waits for memory; who works fails for want of it, and gives back what it
/// held.
#pragma once

namespace trivet::apps::service {

/// From now on, allocations that fail on this thread are tried again for a second, while work on
/// others ends and gives memory back. On others std::bad_alloc is thrown at once, as ever.
void wait_for_memory_on_this_thread() noexcept;

}  // namespace trivet::apps::service

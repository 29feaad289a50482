#include "apps/service/serve/memory_trim.hpp"

#include <malloc.h>

namespace trivet::apps::service {
namespace {

// A trim takes a few milliseconds, and the next scene allocates pages again.
constexpr std::chrono::seconds kInterval{10};
constexpr std::chrono::milliseconds kQuiet{500};

// By default these thresholds grow to 32 and 64 MiB with the freed sizes, and malloc_trim leaves
// the free end of a thread's arena alone.
constexpr int kLargestInArena = 4 << 20, kLargestFreeEnd = 1 << 20;

}  // namespace

MemoryTrim::MemoryTrim() {
  mallopt(M_MMAP_THRESHOLD, kLargestInArena);
  mallopt(M_TRIM_THRESHOLD, kLargestFreeEnd);
}

void MemoryTrim::trim(bool is_busy) {
  const auto now = Clock::now();
  if (is_busy) last_busy_ = now;
  const bool has_ended = last_busy_ > last_ && now - last_busy_ >= kQuiet;
  if (!has_ended && now - last_ < kInterval) return;
  malloc_trim(0);
  last_ = now;
}

}  // namespace trivet::apps::service

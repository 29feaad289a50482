#include "apps/serve/memory_trim.hpp"

#include <malloc.h>

namespace trivet::apps {
namespace {

// It takes a few milliseconds, and the next scene takes pages anew.
constexpr std::chrono::seconds kInterval{10};
constexpr std::chrono::milliseconds kQuiet{500};

}  // namespace

void MemoryTrim::look(bool is_busy) {
  const auto now = Clock::now();
  if (is_busy) last_busy_ = now;
  const bool has_ended = last_busy_ > last_ && now - last_busy_ >= kQuiet;
  if (!has_ended && now - last_ < kInterval) return;
  malloc_trim(0);
  last_ = now;
}

}  // namespace trivet::apps

#include "storage/common/stop.hpp"

#include <atomic>
#include <utility>

namespace trivet {
namespace {

thread_local const std::stop_token* current = nullptr;
std::atomic<void (*)()> stop_observer{nullptr};

}  // namespace

StopScope::StopScope(const std::stop_token* stop) noexcept
    : before_(std::exchange(current, stop)) {}
StopScope::~StopScope() { current = before_; }

const std::stop_token* current_stop() noexcept { return current; }

void check_stop() {
  if (auto* const observer = stop_observer.load(std::memory_order_relaxed)) observer();
  if (current != nullptr && current->stop_requested()) throw Stopped();
}

void observe_stop_checks(void (*observer)()) noexcept { stop_observer = observer; }

}  // namespace trivet

#include "storage/common/wait_for_memory.hpp"

#include <atomic>
#include <chrono>
#include <exception>
#include <new>
#include <thread>
#include <utility>

namespace trivet {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kRetryAfter{5};
constexpr std::chrono::seconds kLongestWait{1};

std::atomic<int> num_everywhere{0};
thread_local bool is_patient = false;
thread_local Clock::time_point first_try{}, last_try{};

/// Called by operator new after a failed allocation; it retries when this returns.
void wait_or_throw() {
  if (!is_patient && num_everywhere == 0 && std::uncaught_exceptions() == 0) throw std::bad_alloc();
  const auto now = Clock::now();
  if (now - last_try > 2 * kRetryAfter) first_try = now;  // a different allocation than before
  last_try = now;
  if (now - first_try > kLongestWait) throw std::bad_alloc();
  std::this_thread::sleep_for(kRetryAfter);
}

}  // namespace

void wait_for_memory_on_this_thread() noexcept {
  is_patient = true;
  std::set_new_handler(wait_or_throw);
}

FailWithoutMemory::FailWithoutMemory() noexcept : was_patient_(std::exchange(is_patient, false)) {}
FailWithoutMemory::~FailWithoutMemory() { is_patient = was_patient_; }

WaitForMemoryEverywhere::WaitForMemoryEverywhere() noexcept { ++num_everywhere; }
WaitForMemoryEverywhere::~WaitForMemoryEverywhere() { --num_everywhere; }

}  // namespace trivet

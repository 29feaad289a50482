#include "support/allocations.hpp"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>

namespace {

thread_local std::size_t count = 0, num_bytes = 0, failing = 0, least_failing = 0;
thread_local bool is_spared = false;
std::atomic<std::int64_t> num_until_failure{0};  // none at 0 and below
std::atomic<bool> has_failed{false};

bool fails() noexcept {
  if (num_until_failure.load(std::memory_order_relaxed) <= 0 || is_spared) return false;
  if (--num_until_failure != 0) return false;
  has_failed = true;
  return true;
}

void* allocate_or_null(std::size_t size, std::size_t alignment) noexcept {
  ++count;
  num_bytes += size;
  if (fails()) return nullptr;
  if (failing > 0 && size >= least_failing && --failing == 0) return nullptr;
  const std::size_t whole = (size + alignment - 1) / alignment * alignment;
  return std::aligned_alloc(alignment, whole > 0 ? whole : alignment);
}

void* allocate(std::size_t size, std::size_t alignment) {
  for (;;) {
    if (void* const memory = allocate_or_null(size, alignment)) return memory;
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc();
    handler();
  }
}

constexpr std::size_t kPlain = alignof(std::max_align_t);
std::size_t bytes(std::align_val_t alignment) { return static_cast<std::size_t>(alignment); }

}  // namespace

namespace trivet::test {
std::size_t num_allocations() noexcept { return count; }
std::size_t num_allocated_bytes() noexcept { return num_bytes; }
void fail_allocation(std::int64_t n) noexcept {
  has_failed = false;
  num_until_failure = n;
}
bool has_failed_allocation() noexcept { return has_failed; }
void spare_allocations() noexcept { is_spared = true; }
void fail_own_allocation(std::size_t n, std::size_t least_bytes) noexcept {
  failing = n;
  least_failing = least_bytes;
}
}  // namespace trivet::test

// All forms, so that the runtimes of sanitizers do not replace some of them.
void* operator new(std::size_t n) { return allocate(n, kPlain); }
void* operator new[](std::size_t n) { return allocate(n, kPlain); }
void* operator new(std::size_t n, std::align_val_t a) { return allocate(n, bytes(a)); }
void* operator new[](std::size_t n, std::align_val_t a) { return allocate(n, bytes(a)); }
void* operator new(std::size_t n, const std::nothrow_t&) noexcept {
  return allocate_or_null(n, kPlain);
}
void* operator new[](std::size_t n, const std::nothrow_t&) noexcept {
  return allocate_or_null(n, kPlain);
}
void* operator new(std::size_t n, std::align_val_t a, const std::nothrow_t&) noexcept {
  return allocate_or_null(n, bytes(a));
}
void* operator new[](std::size_t n, std::align_val_t a, const std::nothrow_t&) noexcept {
  return allocate_or_null(n, bytes(a));
}

void operator delete(void* p) noexcept { std::free(p); }
void operator delete[](void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
void operator delete[](void* p, std::size_t) noexcept { std::free(p); }
void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
void operator delete[](void* p, std::align_val_t) noexcept { std::free(p); }
void operator delete(void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }
void operator delete[](void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }
void operator delete(void* p, const std::nothrow_t&) noexcept { std::free(p); }
void operator delete[](void* p, const std::nothrow_t&) noexcept { std::free(p); }
void operator delete(void* p, std::align_val_t, const std::nothrow_t&) noexcept { std::free(p); }
void operator delete[](void* p, std::align_val_t, const std::nothrow_t&) noexcept { std::free(p); }

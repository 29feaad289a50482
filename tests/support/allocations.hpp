/// Counts heap allocations of the calling thread, to prove that a loop makes none or few, and makes
/// a chosen allocation fail.
#pragma once

#include <cstddef>
#include <cstdint>

namespace trivet::test {

/// Number of calls of operator new, in all its forms, by this thread so far.
std::size_t num_allocations() noexcept;

/// Number of bytes requested by these calls.
std::size_t num_allocated_bytes() noexcept;

/// The bytes that a callable requests, freed or not: a measure of its work that is independent of
/// time.
template <class Body>
std::size_t bytes_in(Body&& body) {
  const std::size_t before = num_allocated_bytes();
  body();
  return num_allocated_bytes() - before;
}

/// Makes the n-th call of operator new from now on fail, once, in whichever thread; 0: none. Calls
/// of exempt threads do not count.
void fail_allocation(std::int64_t n) noexcept;
/// Whether an allocation has failed since then.
bool has_failed_allocation() noexcept;
/// Exempts the calling thread.
void spare_allocations() noexcept;
/// Makes the n-th allocation of this thread from now on with at least so many bytes fail, once; 0:
/// none.
void fail_own_allocation(std::size_t n, std::size_t least_bytes = 0) noexcept;

/// The number of allocations that a callable makes.
template <class Body>
std::size_t allocations_in(Body&& body) {
  const std::size_t before = num_allocations();
  body();
  return num_allocations() - before;
}

}  // namespace trivet::test

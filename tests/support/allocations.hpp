/// Count heap allocations of the running thread, to prove that a loop makes none, or few, and let one
/// fail.
#pragma once

#include <cstddef>
#include <cstdint>

namespace trivet::test {

/// Calls of operator new, in all its forms, by this thread so far.
std::size_t num_allocations() noexcept;

/// The bytes that they asked for.
std::size_t num_allocated_bytes() noexcept;

/// The bytes that a callable asks for, freed or not: a measure of its work, whatever the clock says.
template <class Body>
std::size_t bytes_in(Body&& body) {
  const std::size_t before = num_allocated_bytes();
  body();
  return num_allocated_bytes() - before;
}

/// Let the n-th call of operator new from now on find no memory, once, whichever thread makes it; 0:
/// none. Calls of threads that are spared do not count.
void fail_allocation(std::int64_t n) noexcept;
/// Whether one has failed since.
bool has_failed_allocation() noexcept;
/// Of the running thread.
void spare_allocations() noexcept;
/// Let the nth from now on of this thread's allocations of so many bytes or more fail, once; 0: none.
void fail_own_allocation(std::size_t n, std::size_t least_bytes = 0) noexcept;

/// How many allocations a callable makes.
template <class Body>
std::size_t allocations_in(Body&& body) {
  const std::size_t before = num_allocations();
  body();
  return num_allocations() - before;
}

}  // namespace trivet::test

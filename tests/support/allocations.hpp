/// Count heap allocations of the running thread, to prove that a loop makes none.
#pragma once

#include <cstddef>

namespace trivet::test {

/// Calls of operator new, in all its forms, by this thread so far.
std::size_t num_allocations() noexcept;

/// How many allocations a callable makes.
template <class Body>
std::size_t allocations_in(Body&& body) {
  const std::size_t before = num_allocations();
  body();
  return num_allocations() - before;
}

}  // namespace trivet::test

/// The one interface to TBB for loops: a parallel stage is a few lines and repeats no mathematics.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "storage/columns.hpp"

namespace trivet::engine {

/// Call body(first, count) for chunks that cover [0, n). Kernels give the same bits for any
/// chunking, so the scheduler may split as it likes; inputs of one grain run on the calling thread.
template <class Body>
void for_chunks(std::size_t n, std::size_t grain, Body&& body) {
  if (n == 0) return;
  if (n <= grain) {
    body(std::size_t{0}, n);
    return;
  }
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, grain),
                    [&](const auto& range) { body(range.begin(), range.size()); });
}

/// Call body(i) for each i in [0, n).
template <class Body>
void for_each_index(std::size_t n, Body&& body) {
  for_chunks(n, 1, [&](std::size_t first, std::size_t count) {
    for (std::size_t i = first; i < first + count; ++i) body(i);
  });
}

/// Call two stages that do not need one another, each when there is a thread for it.
template <class First, class Second>
void in_parallel(First&& first, Second&& second) {
  tbb::parallel_invoke(std::forward<First>(first), std::forward<Second>(second));
}

/// Working memory that each thread has its own of. It must not carry results from one item to the
/// next.
template <class T>
using PerThread = tbb::enumerable_thread_specific<T>;

/// Turn counts into offsets in place: n counts and one more place become n + 1 offsets. Returns the
/// sum.
inline std::uint64_t counts_to_offsets(std::span<std::uint32_t> counts) noexcept {
  std::uint64_t sum = 0;
  for (std::uint32_t& count : counts) {
    const std::uint32_t here = count;
    count = static_cast<std::uint32_t>(sum);
    sum += here;
  }
  return sum;
}

}  // namespace trivet::engine

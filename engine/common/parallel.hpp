/// The one interface to TBB for loops: a parallel stage is a few lines and repeats no mathematics.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <span>

#include "storage/common/columns.hpp"
#include "storage/common/stop.hpp"

namespace trivet::engine {

/// What a loop's body throws on any thread, kept until all threads have left the loop. TBB would
/// cancel the loops within it instead, and what is made once there (MadeOnce) would be waited for
/// for ever.
class FirstFault {
 public:
  template <class Work>
  void keep(const Work& work) noexcept {
    if (has_one_.load(std::memory_order_relaxed)) return;
    try {
      work();
    } catch (...) {
      if (!has_one_.exchange(true)) fault_ = std::current_exception();
    }
  }
  /// Once all threads are done.
  void rethrow() const {
    if (fault_) std::rethrow_exception(fault_);
  }

 private:
  std::atomic<bool> has_one_{false};
  std::exception_ptr fault_;
};

/// Call body(first, count) for chunks that cover [0, n), of at most a grain each, with
/// check_stop() before each. Kernels give the same bits for any chunking, so the scheduler
/// may split as it likes; inputs of one grain run on the calling thread. Throws what the body throws
/// first, and Stopped.
template <class Body>
void for_chunks(std::size_t n, std::size_t grain, Body&& body) {
  if (n == 0) return;
  if (n <= grain) {
    check_stop();
    body(std::size_t{0}, n);
    return;
  }
  FirstFault fault;
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, n, grain), [&, stop = current_stop()](const auto& range) {
        const StopScope scope(stop);
        fault.keep([&] {
          for (std::size_t first = range.begin(); first < range.end(); first += grain) {
            check_stop();
            body(first, std::min(grain, range.end() - first));
          }
        });
      });
  fault.rethrow();
}

/// Call body(i) for each i in [0, n).
template <class Body>
void for_each_index(std::size_t n, Body&& body) {
  for_chunks(n, 1, [&](std::size_t first, std::size_t) { body(first); });
}

/// Call two stages that do not need one another, each when there is a thread for it.
template <class First, class Second>
void in_parallel(First&& first, Second&& second) {
  for_each_index(2, [&](std::size_t i) {
    if (i == 0) {
      first();
    } else {
      second();
    }
  });
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

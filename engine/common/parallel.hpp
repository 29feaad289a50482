/// The only interface to TBB for loops. A parallel stage takes a few lines and duplicates no
/// mathematics.
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

/// The first exception of a loop's body, kept until all threads have left the loop. TBB would
/// instead cancel the loops nested in it, and waits for values computed there (MadeOnce) would
/// never end.
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
  /// Pre: all threads are finished.
  void rethrow() const {
    if (fault_) std::rethrow_exception(fault_);
  }

 private:
  std::atomic<bool> has_one_{false};
  std::exception_ptr fault_;
};

/// Call body(first, count) for chunks that cover [0, n), each at most one grain long, with
/// check_stop() before each. Kernels give the same bits for any chunking, so the scheduler may
/// split freely; inputs of one grain run on the calling thread. Throws the first exception of the
/// body, and Stopped.
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

/// Call two independent stages, in parallel if a thread is available.
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

/// Scratch memory per thread. It must not carry results from one item to the next.
template <class T>
using PerThread = tbb::enumerable_thread_specific<T>;

/// Convert counts to offsets in place: n counts and one additional element become n + 1 offsets.
/// Returns the sum.
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

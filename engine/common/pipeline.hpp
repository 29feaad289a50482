/// Parallel work whose results are consumed in order.
#pragma once

#include <tbb/info.h>
#include <tbb/parallel_pipeline.h>

#include <atomic>
#include <cstddef>
#include <utility>

namespace trivet::engine {

/// Call prepare(i) for each i in [0, n) in parallel, but only a few items ahead, and use(i,
/// prepared) in order, one at a time. If use returns false, no later item is used.
template <class Prepare, class Use>
void run_pipeline(std::size_t n, Prepare&& prepare, Use&& use) {
  using Prepared = std::pair<std::size_t, decltype(prepare(std::size_t{}))>;
  std::size_t next = 0;
  std::atomic<bool> ended{false};
  tbb::parallel_pipeline(
      2 * static_cast<std::size_t>(tbb::info::default_concurrency()),
      tbb::make_filter<void, std::size_t>(tbb::filter_mode::serial_in_order,
                                          [&](tbb::flow_control& control) {
                                            if (next == n || ended) control.stop();
                                            return next++;
                                          }) &
          tbb::make_filter<std::size_t, Prepared>(tbb::filter_mode::parallel,
                                                  [&](std::size_t i) {
                                                    return Prepared{i, prepare(i)};
                                                  }) &
          tbb::make_filter<Prepared, void>(
              tbb::filter_mode::serial_in_order, [&](Prepared prepared) {
                if (!ended && !use(prepared.first, std::move(prepared.second))) ended = true;
              }));
}

}  // namespace trivet::engine

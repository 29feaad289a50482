/// Progress reports and stop requests of long runs.
#pragma once

#include <cstddef>
#include <functional>
#include <stop_token>
#include <string_view>

namespace trivet {

/// Progress of a run. Reports may come from any thread, one at a time. `item` names what was just
/// finished.
struct Progress {
  std::function<void(std::size_t done, std::size_t total, std::string_view item)> report;
  std::stop_token stop;

  void operator()(std::size_t done, std::size_t total, std::string_view item) const {
    if (report) report(done, total, item);
  }
};

}  // namespace trivet

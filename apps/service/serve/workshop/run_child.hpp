/// Work on files that nobody vouches for, in a process of its own.
#pragma once

#include <chrono>
#include <stop_token>
#include <string>
#include <vector>

#include "storage/common/result.hpp"

namespace trivet::apps::service {

/// What a child may take before it is killed.
struct ChildLimits {
  std::chrono::seconds time{300};
  std::size_t memory_bytes = std::size_t{8} << 30;  ///< of its address space
};

/// Run a program below the priority of this one until it ends; whatever becomes of it, nothing
/// happens here. It dies with this process.
///
/// program  with its arguments
/// stop     kills it
/// Errors: bad_data (what it said last, or what killed it), resumable (stopped), internal (no
/// process could be made).
Result<void> run_child(const std::vector<std::string>& program, const ChildLimits& limits,
                       const std::stop_token& stop);

}  // namespace trivet::apps::service

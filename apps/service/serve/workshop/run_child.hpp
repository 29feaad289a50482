/// Processing of untrusted files in a separate process.
#pragma once

#include <chrono>
#include <stop_token>
#include <string>
#include <vector>

#include "storage/common/result.hpp"

namespace trivet::apps::service {

/// Limits of a child process, which is killed if it exceeds them.
struct ChildLimits {
  std::chrono::seconds time{300};
  std::size_t memory_bytes = std::size_t{8} << 30;  ///< limit of its address space
};

/// Runs a program at a lower priority until it ends. A crash of the program does not affect this
/// process, and the program dies with this process.
///
/// program  command with its arguments
/// stop     kills it
/// Errors: bad_data (its last message, or the signal that killed it), resumable (stopped), internal
/// (no process could be created).
Result<void> run_child(const std::vector<std::string>& program, const ChildLimits& limits,
                       const std::stop_token& stop);

}  // namespace trivet::apps::service

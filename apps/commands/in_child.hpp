/// Work that may crash, in a child process.
#pragma once

#include <functional>

#include "storage/common/result.hpp"

namespace trivet::apps {

/// Runs work in a child process, and returns its result.
///
/// broken  error to return if the child was ended by a signal
/// Pre: no other thread runs. Errors: those of the work; io (no process could be created).
Result<void> in_child(const std::function<Result<void>()>& work, const Error& broken);

}  // namespace trivet::apps

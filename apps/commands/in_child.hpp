/// Work that may break down, in a process that may.
#pragma once

#include <functional>

#include "storage/common/result.hpp"

namespace trivet::apps {

/// Work in a child process, whose result becomes this one's.
///
/// broken  what it means that the child was ended by a signal
/// Pre: no thread works. Errors: those of the work; io (no process could be made).
Result<void> in_child(const std::function<Result<void>()>& work, const Error& broken);

}  // namespace trivet::apps

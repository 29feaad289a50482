#pragma once

#include <cerrno>
#include <string>
#include <system_error>

namespace trivet {

/// What the last system call that failed says.
inline std::string errno_text() { return std::generic_category().message(errno); }

}  // namespace trivet

#pragma once

#include <cerrno>
#include <string>
#include <system_error>

#include "storage/common/result.hpp"

namespace trivet {

/// Error code for a failed write with this errno value.
inline ErrorCode write_error(int number, ErrorCode otherwise) noexcept {
  const bool is_full = number == ENOSPC || number == EDQUOT || number == EFBIG;
  return is_full ? ErrorCode::no_space : otherwise;
}

/// Message of the last failed system call.
inline std::string errno_text() { return std::generic_category().message(errno); }

}  // namespace trivet

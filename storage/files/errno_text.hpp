#pragma once

#include <cerrno>
#include <string>
#include <system_error>

#include "storage/common/result.hpp"

namespace trivet {

/// What a write that failed with this number means.
inline ErrorCode write_error(int number, ErrorCode otherwise) noexcept {
  const bool is_full = number == ENOSPC || number == EDQUOT || number == EFBIG;
  return is_full ? ErrorCode::no_space : otherwise;
}

/// What the last system call that failed says.
inline std::string errno_text() { return std::generic_category().message(errno); }

}  // namespace trivet

/// Uniform error message for options out of range.
#pragma once

#include <fmt/format.h>

#include <initializer_list>
#include <string_view>

#include "storage/common/result.hpp"

namespace trivet::engine {

struct RangeCheck {
  bool ok;                  ///< condition, written as a comparison so that it is false for NaN
  std::string_view option;  ///< name for users
  std::string_view range;
  double value;
};

/// Returns a usage error for the first check that fails.
inline Result<void> check_ranges(std::initializer_list<RangeCheck> checks) {
  for (const RangeCheck& check : checks) {
    if (!check.ok) {
      return Error{ErrorCode::usage, fmt::format("{}: expected {}, found {}", check.option,
                                                 check.range, check.value)};
    }
  }
  return {};
}

}  // namespace trivet::engine

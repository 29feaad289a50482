/// One sentence for every option that is out of range.
#pragma once

#include <fmt/format.h>

#include <initializer_list>
#include <string_view>

#include "storage/common/result.hpp"

namespace trivet::engine {

struct RangeCheck {
  bool ok;                  ///< false for NaN too, when written as a comparison that must hold
  std::string_view option;  ///< as a person would name it
  std::string_view range;
  double value;
};

/// The first check that does not hold becomes a usage error.
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

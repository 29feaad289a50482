/// A value other than the default for each option.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/options/option.hpp"

namespace trivet::test {

/// A value within the range that is not the default.
inline OptionValue changed_value(const OptionInfo& info, const OptionValue& usual) {
  const auto other_number = [&] {
    const double low = std::max(info.range.low, 0.0);
    const double high = std::isfinite(info.range.high) ? info.range.high : low + 100;
    for (const double share : {0.25, 0.5}) {
      const double number = info.kind == OptionKind::count
                                ? std::floor(low + share * std::min(high - low, 100.0)) + 1
                                : low + share * (high - low);
      if (OptionValue(number) != usual) return number;
    }
    return high;
  };
  switch (info.kind) {
    case OptionKind::flag:
      return !std::get<bool>(usual);
    case OptionKind::number:
    case OptionKind::count:
      return std::min(other_number(), info.range.high);
    case OptionKind::choice:
      return std::string(info.choices.back().name == std::get<std::string>(usual)
                             ? info.choices.front().name
                             : info.choices.back().name);
    case OptionKind::numbers: {
      std::vector<double> numbers(info.length, 1);
      numbers.front() = 0.5;
      return numbers;
    }
    case OptionKind::names:
      break;
  }
  return std::vector<std::string>{info.choices.empty() ? "bolt"
                                                       : std::string(info.choices.back().name)};
}

/// The value in the form of a command line or a query.
inline std::string text_of(const OptionValue& value) {
  if (const bool* const flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  std::string text = value_text(value);
  std::erase(text, ' ');
  return text;
}

}  // namespace trivet::test

/// Where hypotheses come from; all are verified alike.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace trivet {

enum class Method : std::uint8_t { ppf, trisi };

struct MethodName {
  Method method;
  std::string_view name;
  std::string_view sentence;
};

/// By their values.
inline constexpr std::array<MethodName, 2> kMethods{{
    {Method::ppf, "ppf", "votes of point pairs (Drost et al., CVPR 2010)"},
    {Method::trisi, "trisi", "matches of Tri-Spin-Images (Guo et al., GRAPP 2013)"},
}};

constexpr std::string_view name_of(Method method) noexcept {
  return kMethods[static_cast<std::size_t>(method)].name;
}

}  // namespace trivet

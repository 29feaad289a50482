/// Where hypotheses come from; all are verified alike.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace trivet {

/// What proposes poses; of several, the first one counts.
enum class Source : std::uint8_t { expected, ppf, trisi };

/// What a scene is searched by.
enum class Method : std::uint8_t { fused, ppf, trisi };

struct MethodName {
  Method method;
  std::string_view name;
  std::string_view sentence;
};

/// By their values.
inline constexpr std::array<MethodName, 3> kMethods{{
    {Method::fused, "fused", "point pairs, then both of these on what is not yet explained"},
    {Method::ppf, "ppf", "votes of point pairs (Drost et al., CVPR 2010)"},
    {Method::trisi, "trisi", "matches of Tri-Spin-Images (Guo et al., GRAPP 2013)"},
}};

constexpr std::string_view name_of(Source source) noexcept {
  constexpr std::array<std::string_view, 3> kNames{"expected", "ppf", "trisi"};
  return kNames[static_cast<std::size_t>(source)];
}

}  // namespace trivet

/// Where hypotheses come from; all are verified alike.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "engine/options/option.hpp"

namespace trivet {

/// What proposes poses; of several, the first one counts.
enum class Source : std::uint8_t { expected, ppf, trisi };

/// What a scene is searched by.
enum class Method : std::uint8_t { fused, ppf, trisi };

/// The names of the methods.
template <>
std::span<const Choice> choices_of<Method>();

/// As results name it.
constexpr std::string_view name_of(Source source) noexcept {
  constexpr std::array<std::string_view, 3> kNames{"expected", "ppf", "trisi"};
  return kNames[static_cast<std::size_t>(source)];
}

}  // namespace trivet

/// Sources of hypotheses. All hypotheses are verified in the same way.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "engine/options/option.hpp"

namespace trivet {

/// Source of a proposed pose. If several sources propose it, the first one in this order counts.
enum class Source : std::uint8_t { expected, ppf, trisi };

/// Methods of searching a scene.
enum class Method : std::uint8_t { fused, ppf, trisi };

/// The names of the methods.
template <>
std::span<const Choice> choices_of<Method>();

/// Name in results.
constexpr std::string_view name_of(Source source) noexcept {
  constexpr std::array<std::string_view, 3> kNames{"expected", "ppf", "trisi"};
  return kNames[static_cast<std::size_t>(source)];
}

/// What proposed the pose, in words.
constexpr std::string_view words_of(Source source) noexcept {
  constexpr std::array<std::string_view, 3> kWords{"an expected pose", "point pairs",
                                                   "Tri-Spin-Images"};
  return kWords[static_cast<std::size_t>(source)];
}

}  // namespace trivet

/// What a name that nobody knows was probably meant to be.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace trivet {

/// The known name that differs by the fewest letters inserted, removed, replaced or swapped with
/// their neighbor (optimal string alignment), the first of several; case, dashes and underscores do
/// not count. Empty where more than a third of the letters differ.
std::string_view nearest_name(std::string_view name, std::span<const std::string_view> known);

/// "found 'scal'; did you mean 'scale'?", or, where none is near, "expected one of file, scale, found
/// 'color'".
std::string unknown_name(std::string_view name, std::span<const std::string_view> known);

}  // namespace trivet

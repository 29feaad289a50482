/// Suggestions for unknown names.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace trivet {

/// The known name at the smallest edit distance, with letters inserted, removed, replaced or
/// swapped with their neighbor (optimal string alignment); the first of several. Case, dashes and
/// underscores do not count. Empty if more than a third of the letters differ.
std::string_view nearest_name(std::string_view name, std::span<const std::string_view> known);

/// "found 'scal'; did you mean 'scale'?", or, without a near name, "expected one of file, scale,
/// found 'color'".
std::string unknown_name(std::string_view name, std::span<const std::string_view> known);

}  // namespace trivet

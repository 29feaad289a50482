/// Counts with their nouns, for messages.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace trivet {

/// "1 scene", "3 scenes"; "0 vertices" if the plural is not the singular with an s.
inline std::string counted(std::size_t n, std::string_view one, std::string_view many = {}) {
  std::string text = std::to_string(n) + ' ';
  if (n == 1) return text.append(one);
  return many.empty() ? text.append(one) + 's' : text.append(many);
}

}  // namespace trivet

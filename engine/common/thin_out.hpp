/// A subset spread evenly over a sequence.
#pragma once

#include <cstddef>
#include <vector>

namespace trivet::engine {

/// Keep at most `limit` elements, spread evenly, in their order.
template <class T, class Allocator>
void thin_out(std::size_t limit, std::vector<T, Allocator>& all) {
  if (all.size() <= limit) return;
  for (std::size_t k = 0; k < limit; ++k) all[k] = all[k * all.size() / limit];
  all.erase(all.begin() + static_cast<std::ptrdiff_t>(limit), all.end());
}

}  // namespace trivet::engine

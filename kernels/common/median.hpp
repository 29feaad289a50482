/// The median of numbers.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace trivet::kernels {

/// The median; the upper of the two middle values, 0 for none. Reorders the values. No allocation.
template <class Number>
Number median(std::span<Number> values) noexcept {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace trivet::kernels

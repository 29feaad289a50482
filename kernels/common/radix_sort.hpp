/// Sorting of integer keys with an index each, in linear time.
#pragma once

#include <cstdint>

#include "storage/common/columns.hpp"

namespace trivet::kernels {

struct RadixScratch {
  Column<std::uint64_t> keys;
  Column<std::uint32_t> values;
};

/// Sort keys in ascending order and move each value with its key. Stable.
///
/// keys     n keys, none above max_key
/// values   n values
/// max_key  determines the number of passes: one for each 11 bits
/// Cost: O(n) per pass. Allocates only if scratch is smaller than n.
void radix_sort(Column<std::uint64_t>& keys, Column<std::uint32_t>& values, std::uint64_t max_key,
                RadixScratch& scratch);

}  // namespace trivet::kernels

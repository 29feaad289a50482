/// Sort integer keys and carry an index with each, in time linear in their number.
#pragma once

#include <cstdint>

#include "storage/common/columns.hpp"

namespace trivet::kernels {

struct RadixScratch {
  Column<std::uint64_t> keys;
  Column<std::uint32_t> values;
};

/// Sort keys to rising order and move each value with its key. Equal keys keep their order.
///
/// keys     n keys, none above max_key
/// values   n values
/// max_key  sets the number of passes: one for each 11 bits
/// Cost: O(n) a pass. Allocates only where scratch is smaller than n.
void radix_sort(Column<std::uint64_t>& keys, Column<std::uint32_t>& values, std::uint64_t max_key,
                RadixScratch& scratch);

}  // namespace trivet::kernels

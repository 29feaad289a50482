/// From codes to an inverted file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "storage/columns.hpp"

namespace trivet::engine {

/// What kernels::CodeIndexView refers to, but for the codes, whose order it gives.
struct CodeLists {
  Column<std::uint8_t> centroids;
  std::vector<std::uint32_t> offsets;  ///< where each list begins, and the end of the last
  std::vector<std::uint32_t> order;    ///< of the codes, list by list, rising in each
};

/// Put each code into the list of its nearest centroid. Lists hold some 2,000 codes whatever their
/// number; centroids are found by Lloyd's iterations over codes spread over the input.
///
/// codes  0 < n < 2^32 of `stride` bytes each (kernels::code_stride)
/// Same bytes for any number of threads.
CodeLists build_code_lists(std::span<const std::uint8_t> codes, std::size_t stride);

}  // namespace trivet::engine

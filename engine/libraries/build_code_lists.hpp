/// Conversion of codes to an inverted file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/libraries/code_source.hpp"
#include "storage/common/columns.hpp"

namespace trivet::engine {

/// Assignment of codes to lists. Sorted by list, and rising within each, the codes form the layout
/// that kernels::CodeIndexView refers to.
struct CodeLists {
  Column<std::uint8_t> centroids;
  std::vector<std::uint32_t> offsets;  ///< start of each list, and the end of the last one
  std::vector<std::uint32_t> list;     ///< list of each code
};

/// Assign each code to the list of its nearest centroid (CentroidFinder). Lists contain about 2,000
/// codes, regardless of the total number.
///
/// All codes are read twice. Uses 4 bytes per code, and before that 2 per code for the centroids.
/// Same bytes for any number of threads.
CodeLists build_code_lists(const CodeSource& codes);

/// Build lists for codes in memory, of `stride` bytes each.
CodeLists build_code_lists(std::span<const std::uint8_t> codes, std::size_t stride);

}  // namespace trivet::engine

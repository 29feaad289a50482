/// From codes to an inverted file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/libraries/code_source.hpp"
#include "storage/common/columns.hpp"

namespace trivet::engine {

/// Which list each code stands in: list by list, and rising in each, they are what
/// kernels::CodeIndexView refers to.
struct CodeLists {
  Column<std::uint8_t> centroids;
  std::vector<std::uint32_t> offsets;  ///< where each list begins, and the end of the last
  std::vector<std::uint32_t> list;     ///< of each code
};

/// Put each code into the list of its nearest centroid (CentroidFinder). Lists hold some 2,000 codes
/// whatever their number.
///
/// All codes are read twice. Takes 4 bytes a code, and before that 2 a code for the centroids.
/// Same bytes for any number of threads.
CodeLists build_code_lists(const CodeSource& codes);

/// Of codes in memory, of `stride` bytes each.
CodeLists build_code_lists(std::span<const std::uint8_t> codes, std::size_t stride);

}  // namespace trivet::engine

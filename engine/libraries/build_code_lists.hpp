/// From codes to an inverted file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "storage/columns.hpp"

namespace trivet::engine {

/// Codes wherever they lie: they need not be in memory together.
struct CodeSource {
  std::size_t size = 0;    ///< 0 < size < 2^32
  std::size_t stride = 0;  ///< bytes of each, filled up with zeros: kernels::code_stride
  /// Write those from `first` on. Called from many threads, for a few thousand at a time.
  std::function<void(std::size_t first, std::span<std::uint8_t> codes)> read;
};

/// Which list each code stands in: list by list, and rising in each, they are what
/// kernels::CodeIndexView refers to.
struct CodeLists {
  Column<std::uint8_t> centroids;
  std::vector<std::uint32_t> offsets;  ///< where each list begins, and the end of the last
  std::vector<std::uint32_t> list;     ///< of each code
};

/// Put each code into the list of its nearest centroid. Lists hold some 2,000 codes whatever their
/// number; centroids are found by Lloyd's iterations over codes spread over the input.
///
/// All codes are read twice. Takes 4 bytes a code, and before that 2 a code for the centroids.
/// Same bytes for any number of threads.
CodeLists build_code_lists(const CodeSource& codes);

/// Of codes in memory, of `stride` bytes each.
CodeLists build_code_lists(std::span<const std::uint8_t> codes, std::size_t stride);

}  // namespace trivet::engine

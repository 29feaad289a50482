/// Codes that need not be in memory together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

namespace trivet::engine {

/// Codes wherever they lie.
struct CodeSource {
  std::size_t size = 0;    ///< 0 < size < 2^32
  std::size_t stride = 0;  ///< bytes of each, filled up with zeros: kernels::code_stride
  /// Write those from `first` on. Called from many threads, for some thousands at a time.
  std::function<void(std::size_t first, std::span<std::uint8_t> codes)> read;
};

/// Of codes in memory, of `stride` bytes each, which outlive it.
CodeSource source_of(std::span<const std::uint8_t> codes, std::size_t stride);

/// Call `body` with blocks of at most `at_once` codes that cover all, from many threads.
void for_blocks(
    const CodeSource& codes, std::size_t at_once,
    const std::function<void(std::size_t first, std::span<const std::uint8_t> block)>& body);

}  // namespace trivet::engine

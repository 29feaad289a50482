/// Codes that need not be in memory together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

namespace trivet::engine {

/// Access to codes, wherever they are stored.
struct CodeSource {
  std::size_t size = 0;    ///< 0 < size < 2^32
  std::size_t stride = 0;  ///< bytes per code, padded with zeros: kernels::code_stride
  /// Write the codes from `first` on. Called from many threads, for some thousands at a time.
  std::function<void(std::size_t first, std::span<std::uint8_t> codes)> read;
};

/// A source of codes in memory, of `stride` bytes each, which must outlive it.
CodeSource source_of(std::span<const std::uint8_t> codes, std::size_t stride);

/// Call `body` for blocks of at most `at_once` codes that cover all codes, from many threads.
void for_blocks(
    const CodeSource& codes, std::size_t at_once,
    const std::function<void(std::size_t first, std::span<const std::uint8_t> block)>& body);

}  // namespace trivet::engine

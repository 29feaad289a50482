/// The LZF compression that binary_compressed PCD files use.
#pragma once

#include <cstddef>
#include <span>

namespace trivet::formats {

/// Largest possible compression ratio: three bytes give at most 264.
inline constexpr std::size_t kMaxLzfRatio = 88;

/// Decompress into `out`; false if the stream is broken or does not give exactly out.size() bytes.
/// Reads and writes nothing outside the two spans.
bool decompress_lzf(std::span<const std::byte> in, std::span<std::byte> out) noexcept;

}  // namespace trivet::formats

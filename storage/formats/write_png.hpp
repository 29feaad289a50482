/// PNG encoding of pixel rows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "storage/common/result.hpp"

namespace trivet {

/// An image of 8-bit red, green and blue, row by row.
struct Picture {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  ///< 3 * width * height
};

/// Encode as PNG. Errors: internal (libpng's message).
Result<std::vector<std::byte>> encode_png(const Picture& picture);

/// Write whole rows of depths as a 16-bit gray PNG that read_cloud can read; 0 stands for no
/// measurement. The file appears whole or not at all. Errors: cannot_create, io, internal (libpng's
/// message).
Result<void> write_depth_png(const std::filesystem::path& file,
                             std::span<const std::uint16_t> depths, std::uint32_t width);

/// Write an 8-bit gray PNG of whole rows. The file appears whole or not at all. Errors: those of
/// write_depth_png.
Result<void> write_gray_png(const std::filesystem::path& file, std::span<const std::uint8_t> pixels,
                            std::uint32_t width);

}  // namespace trivet

#include "storage/formats/lzf.hpp"

#include <algorithm>

namespace trivet::formats {

// A control byte below 32 is followed by that many literal bytes plus one. Any other is a copy of
// earlier output: its top three bits are the length minus two (7: the next byte adds to it), the
// other five and the next byte the distance minus one.
bool decompress_lzf(std::span<const std::byte> in, std::span<std::byte> out) noexcept {
  std::size_t from = 0, to = 0;
  while (from < in.size()) {
    const auto control = std::to_integer<std::size_t>(in[from++]);
    if (control < 32) {
      const std::size_t length = control + 1;
      if (in.size() - from < length || out.size() - to < length) return false;
      std::copy_n(in.begin() + static_cast<std::ptrdiff_t>(from), length,
                  out.begin() + static_cast<std::ptrdiff_t>(to));
      from += length;
      to += length;
      continue;
    }
    std::size_t length = (control >> 5) + 2;
    if (length == 9) {
      if (from == in.size()) return false;
      length += std::to_integer<std::size_t>(in[from++]);
    }
    if (from == in.size()) return false;
    const std::size_t distance =
        ((control & 31) << 8) + std::to_integer<std::size_t>(in[from++]) + 1;
    if (distance > to || out.size() - to < length) return false;
    // Byte by byte: source and target overlap when a short pattern repeats.
    for (; length > 0; --length, ++to) out[to] = out[to - distance];
  }
  return to == out.size();
}

}  // namespace trivet::formats

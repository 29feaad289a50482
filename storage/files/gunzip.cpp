#include "storage/files/gunzip.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "storage/files/inflater.hpp"

namespace trivet {
namespace {

/// Process all members; store their contents as far as `out` has room, and return the total size.
Result<std::uint64_t> unpack(std::span<const std::byte> packed, std::string_view name,
                             std::uint64_t max_bytes, std::span<std::byte> out) {
  const auto refuse = [&](std::string_view what) {
    return Error{ErrorCode::bad_data, fmt::format("{}: {}", name, what)};
  };
  std::array<std::byte, 1 << 16> dropped;
  Inflater inflater(PackedFrame::gzip, packed);
  const auto place = [&] { return packed.size() - inflater.rest().size(); };
  std::uint64_t size = 0;
  while (true) {
    std::size_t produced = 0;
    const bool kept = size < out.size();
    const int answer =
        inflater.step(kept ? out.subspan(static_cast<std::size_t>(size)) : dropped, produced);
    size += produced;
    if (size > max_bytes) {
      return refuse(
          fmt::format("{} bytes of gzip unpack to more than the limit of {} bytes; expected a "
                      "scan or model, found what looks like a decompression bomb",
                      packed.size(), max_bytes));
    }
    if (answer == Z_STREAM_END) {
      if (is_gzip(inflater.rest())) {
        inflater.begin_member();
        continue;
      }
      // Tapes and some writers pad with zeros.
      const auto is_zero = [](std::byte byte) { return byte == std::byte{0}; };
      if (std::ranges::all_of(inflater.rest(), is_zero)) return size;
      return refuse(
          fmt::format("byte {}: expected the end of the gzip file, found {} more bytes; it is "
                      "damaged, or two files were joined",
                      place(), inflater.rest().size()));
    }
    if (answer == Z_BUF_ERROR || (answer == Z_OK && produced == 0 && inflater.rest().empty())) {
      return refuse(
          fmt::format("byte {}: expected more of the gzip file, found its end; the file is "
                      "truncated",
                      place()));
    }
    if (answer != Z_OK) {
      return refuse(
          fmt::format("byte {}: the gzip file is damaged: {}", place(), inflater.fault()));
    }
  }
}

}  // namespace

bool is_gzip(std::span<const std::byte> bytes) noexcept {
  return bytes.size() >= 2 && bytes[0] == std::byte{0x1F} && bytes[1] == std::byte{0x8B};
}

Result<std::vector<std::byte>> gunzip(std::span<const std::byte> packed, std::string_view name,
                                      std::uint64_t max_bytes) {
  TRIVET_TRY_ASSIGN(const std::uint64_t size, unpack(packed, name, max_bytes, {}));
  std::vector<std::byte> bytes(static_cast<std::size_t>(size));
  TRIVET_TRY(unpack(packed, name, max_bytes, bytes));
  return bytes;
}

}  // namespace trivet

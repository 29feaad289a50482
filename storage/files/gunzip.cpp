#include "storage/files/gunzip.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <limits>
#include <new>

namespace trivet {
namespace {

/// zlib's stream over one gzip member after the other.
class Inflater {
 public:
  explicit Inflater(std::span<const std::byte> packed) : rest_(packed) {
    constexpr int kGzipOnly = 16;
    if (inflateInit2(&stream_, MAX_WBITS + kGzipOnly) != Z_OK) throw std::bad_alloc();
  }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
  ~Inflater() { inflateEnd(&stream_); }

  /// Unpack into `out` until it is full or a member ends; zlib's answer, and how much there is.
  int step(std::span<std::byte> out, std::size_t& produced) {
    const std::size_t given = std::min<std::size_t>(rest_.size(), kMostAtOnce);
    const std::size_t room = std::min<std::size_t>(out.size(), kMostAtOnce);
    // zlib's input is not const, and is not written to either.
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(rest_.data()));
    stream_.avail_in = static_cast<uInt>(given);
    stream_.next_out = reinterpret_cast<Bytef*>(out.data());
    stream_.avail_out = static_cast<uInt>(room);
    const int answer = inflate(&stream_, Z_NO_FLUSH);
    rest_ = rest_.subspan(given - stream_.avail_in);
    produced = room - stream_.avail_out;
    return answer;
  }
  void begin_member() { inflateReset(&stream_); }

  std::span<const std::byte> rest() const noexcept { return rest_; }
  std::string_view fault() const noexcept { return stream_.msg ? stream_.msg : "broken stream"; }

 private:
  static constexpr std::size_t kMostAtOnce = std::numeric_limits<uInt>::max();
  z_stream stream_{};
  std::span<const std::byte> rest_;
};

/// Go over all members, and keep what they hold where `out` has room for it; its size.
Result<std::uint64_t> unpack(std::span<const std::byte> packed, std::string_view name,
                             std::uint64_t max_bytes, std::span<std::byte> out) {
  const auto refuse = [&](std::string_view what) {
    return Error{ErrorCode::bad_data, fmt::format("{}: {}", name, what)};
  };
  std::array<std::byte, 1 << 16> dropped;
  Inflater inflater(packed);
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
    if (answer == Z_MEM_ERROR) throw std::bad_alloc();
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
  const Result<std::uint64_t> size = unpack(packed, name, max_bytes, {});
  if (!size) return size.error();
  std::vector<std::byte> bytes(static_cast<std::size_t>(*size));
  const Result<std::uint64_t> done = unpack(packed, name, max_bytes, bytes);
  if (!done) return done.error();
  return bytes;
}

}  // namespace trivet

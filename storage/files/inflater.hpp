/// Streaming decompression by zlib of data in memory.
#pragma once

#include <zlib.h>

#include <algorithm>
#include <cstddef>
#include <new>
#include <span>
#include <string_view>

#include "storage/common/stop.hpp"

namespace trivet {

/// Container of the compressed data: RFC 1952 or RFC 1950.
enum class PackedFrame { gzip, zlib };

/// zlib's windowBits parameter for the container, for compression and decompression.
constexpr int window_bits(PackedFrame frame) noexcept {
  constexpr int kGzip = 16;
  return frame == PackedFrame::gzip ? MAX_WBITS + kGzip : MAX_WBITS;
}

/// Decompresses piece by piece. The compressed bytes must stay in place.
class Inflater {
 public:
  /// Throws std::bad_alloc.
  Inflater(PackedFrame frame, std::span<const std::byte> packed) : rest_(packed) {
    if (inflateInit2(&stream_, window_bits(frame)) != Z_OK) throw std::bad_alloc();
  }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
  ~Inflater() { inflateEnd(&stream_); }

  /// Check for a stop request, then decompress into `out` until it is full, a member ends or a
  /// limit for one step is reached.
  /// produced  number of bytes in `out` now
  /// Returns zlib's return code. Throws std::bad_alloc.
  int step(std::span<std::byte> out, std::size_t& produced) {
    check_stop();
    const std::size_t given = std::min<std::size_t>(rest_.size(), kMostAtOnce);
    const std::size_t room = std::min<std::size_t>(out.size(), kMostAtOnce);
    // zlib's input pointer is not const, but zlib does not write to it.
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(rest_.data()));
    stream_.avail_in = static_cast<uInt>(given);
    stream_.next_out = reinterpret_cast<Bytef*>(out.data());
    stream_.avail_out = static_cast<uInt>(room);
    const int answer = inflate(&stream_, Z_NO_FLUSH);
    if (answer == Z_MEM_ERROR) throw std::bad_alloc();
    rest_ = rest_.subspan(given - stream_.avail_in);
    produced = room - stream_.avail_out;
    return answer;
  }
  /// Continue with the next member after one has ended.
  void begin_member() { inflateReset(&stream_); }

  std::span<const std::byte> rest() const noexcept {
    return rest_;
  }  ///< compressed bytes not yet
     ///< read
  std::string_view fault() const noexcept { return stream_.msg ? stream_.msg : "broken data"; }

 private:
  static constexpr std::size_t kMostAtOnce = 4 << 20;  ///< limit for one step, some 20 ms
  z_stream stream_{};
  std::span<const std::byte> rest_;
};

}  // namespace trivet

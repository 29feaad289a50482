/// Compression of bodies, independent of the service.
#pragma once

#include <zlib.h>

#include <string>
#include <string_view>

namespace trivet::test {

enum class Packing { gzip, zlib };

inline std::string pack(Packing packing, std::string_view bytes) {
  z_stream stream{};
  const int window = packing == Packing::gzip ? MAX_WBITS + 16 : MAX_WBITS;
  deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, window, 8, Z_DEFAULT_STRATEGY);
  std::string out(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

/// Decompresses gzip or zlib, up to 16 MB.
inline std::string unpack(std::string_view packed) {
  z_stream stream{};
  inflateInit2(&stream, MAX_WBITS + 32);
  std::string out(16 << 20, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  const bool is_complete = inflate(&stream, Z_FINISH) == Z_STREAM_END;
  out.resize(is_complete ? stream.total_out : 0);
  inflateEnd(&stream);
  return out;
}

}  // namespace trivet::test

#include "apps/service/http/content_coding.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <new>
#include <span>

#include "storage/files/inflater.hpp"
#include "storage/files/numbers.hpp"
#include "storage/files/text.hpp"

namespace trivet::apps::service {
namespace {

constexpr std::size_t kStep = 256 << 10;  ///< bytes to decompress at a time

PackedFrame frame_of(ContentCoding coding) {
  return coding == ContentCoding::gzip ? PackedFrame::gzip : PackedFrame::zlib;
}

Result<std::string> inflate_all(ContentCoding coding, std::string_view packed,
                                std::size_t max_bytes) {
  Inflater inflater(frame_of(coding), std::as_bytes(std::span(packed)));
  std::string out;
  const auto refuse = [&](std::string_view what) {
    return Error{ErrorCode::bad_data, fmt::format("{} body: byte {}: {}", coding_name(coding),
                                                  packed.size() - inflater.rest().size(), what)};
  };
  while (out.size() <= max_bytes) {
    const std::size_t before = out.size();
    std::size_t produced = 0;
    out.resize(before + std::min(max_bytes + 1 - before, kStep));
    const int answer =
        inflater.step(std::as_writable_bytes(std::span(out)).subspan(before), produced);
    out.resize(before + produced);
    if (answer == Z_STREAM_END) {
      if (inflater.rest().empty()) break;
      // RFC 1952, 2.2: members follow one another, each with the same first byte.
      constexpr std::byte kFirstByte{0x1F};
      if (coding != ContentCoding::gzip || inflater.rest()[0] != kFirstByte)
        return refuse("expected its end, found bytes behind the data");
      inflater.begin_member();
    } else if (answer == Z_BUF_ERROR) {
      return refuse("expected more data, found its end");
    } else if (answer != Z_OK) {
      return refuse(inflater.fault());
    }
  }
  return out;
}

std::string trimmed(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c != ' ' && c != '\t') out += c;
  }
  return formats::lower_case(out);
}

/// The preference of each coding of an Accept-Encoding header, 0 to 1.
std::map<std::string, double, std::less<>> likings(std::string_view accept_encoding) {
  std::map<std::string, double, std::less<>> out;
  const std::string all = trimmed(accept_encoding) + ',';
  for (std::size_t at = 0, end = 0; (end = all.find(',', at)) != all.npos; at = end + 1) {
    const std::string one = all.substr(at, end - at);
    const std::size_t semicolon = std::min(one.find(";q="), one.size());
    const bool has_weight = semicolon < one.size();
    out[one.substr(0, semicolon)] =
        has_weight ? parse_number(one.substr(semicolon + 3)).value_or(0) : 1;
  }
  return out;
}

}  // namespace

std::string_view coding_name(ContentCoding coding) {
  switch (coding) {
    case ContentCoding::identity:
      return "identity";
    case ContentCoding::gzip:
      return "gzip";
    case ContentCoding::deflate:
      return "deflate";
  }
  return "";
}

std::optional<ContentCoding> content_coding(std::string_view content_encoding) {
  const std::string name = trimmed(content_encoding);
  if (name.empty() || name == "identity") return ContentCoding::identity;
  if (name == "gzip" || name == "x-gzip") return ContentCoding::gzip;
  if (name == "deflate") return ContentCoding::deflate;
  return std::nullopt;
}

ContentCoding accepted_coding(std::string_view accept_encoding) {
  const auto liked = likings(accept_encoding);
  const auto liking = [&](ContentCoding coding) {
    const auto named = liked.find(coding_name(coding));
    if (named != liked.end()) return named->second;
    const auto any = liked.find("*");
    return any == liked.end() ? 0 : any->second;
  };
  ContentCoding best = ContentCoding::identity;
  // Identity is always acceptable unless it is named; any named coding is preferred to it.
  double most = liked.contains("identity") ? liking(best) : 0;
  for (const ContentCoding coding : {ContentCoding::gzip, ContentCoding::deflate}) {
    if (liking(coding) <= most) continue;
    best = coding;
    most = liking(coding);
  }
  return best;
}

Result<std::string> unpack(ContentCoding coding, std::string_view packed, std::size_t max_bytes) {
  try {
    return inflate_all(coding, packed, max_bytes);
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::no_memory, fmt::format("body: {}", kOutOfMemory)};
  }
}

std::optional<std::string> pack(ContentCoding coding, std::string_view bytes) {
  constexpr int kMemoryLevel = 8;  // zlib's default
  z_stream stream{};
  if (deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, window_bits(frame_of(coding)), kMemoryLevel,
                   Z_DEFAULT_STRATEGY) != Z_OK) {
    return std::nullopt;
  }
  std::optional<std::string> out;
  try {
    out.emplace(deflateBound(&stream, bytes.size()), '\0');
    // zlib's input is not const, and is not written to either.
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(out->data());
    stream.avail_out = static_cast<uInt>(out->size());
    if (deflate(&stream, Z_FINISH) == Z_STREAM_END) {
      out->resize(stream.total_out);
    } else {
      out.reset();  // 4 GB and more
    }
  } catch (const std::bad_alloc&) {
    out.reset();
  }
  deflateEnd(&stream);
  return out;
}

}  // namespace trivet::apps::service

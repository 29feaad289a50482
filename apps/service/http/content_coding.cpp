#include "apps/service/http/content_coding.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <limits>
#include <map>
#include <new>

namespace trivet::apps::service {
namespace {

constexpr std::size_t kStep = 256 << 10;  ///< bytes to unpack at a time

/// What zlib takes for the frame around its data.
int window_bits(ContentCoding coding) {
  constexpr int kGzip = 16;
  return coding == ContentCoding::gzip ? MAX_WBITS + kGzip : MAX_WBITS;
}

// zlib's input is not const, and is not written to either.
Bytef* input_of(std::string_view bytes) {
  return reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
}

class Inflater {
 public:
  Inflater(ContentCoding coding, std::string_view packed) : packed_(packed) {
    if (inflateInit2(&stream_, window_bits(coding)) != Z_OK) throw std::bad_alloc();
  }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
  ~Inflater() { inflateEnd(&stream_); }

  /// Add up to a step to `out`. Returns zlib's answer.
  int step(std::string& out, std::size_t room) {
    const std::size_t before = out.size();
    const std::string_view rest = packed_.substr(at_);
    out.resize(before + std::min(room, kStep));
    stream_.next_in = input_of(rest);
    stream_.avail_in = static_cast<uInt>(std::min<std::size_t>(rest.size(), kMostAtOnce));
    stream_.next_out = reinterpret_cast<Bytef*>(out.data() + before);
    stream_.avail_out = static_cast<uInt>(out.size() - before);
    const int answer = inflate(&stream_, Z_NO_FLUSH);
    out.erase(out.size() - stream_.avail_out);
    at_ += static_cast<std::size_t>(stream_.next_in - input_of(rest));
    return answer;
  }
  void begin_member() { inflateReset(&stream_); }

  std::size_t place() const { return at_; }
  bool is_at_end() const { return at_ == packed_.size(); }
  std::string_view fault() const { return stream_.msg ? stream_.msg : "broken data"; }

 private:
  static constexpr std::size_t kMostAtOnce = std::numeric_limits<uInt>::max();
  z_stream stream_{};
  const std::string_view packed_;
  std::size_t at_ = 0;
};

Result<std::string> inflate_all(ContentCoding coding, std::string_view packed,
                                std::size_t max_bytes) {
  Inflater inflater(coding, packed);
  std::string out;
  const auto refuse = [&](std::string_view what) {
    return Error{ErrorCode::bad_data,
                 fmt::format("{} body: byte {}: {}", coding_name(coding), inflater.place(), what)};
  };
  while (out.size() <= max_bytes) {
    const int answer = inflater.step(out, max_bytes + 1 - out.size());
    if (answer == Z_MEM_ERROR) throw std::bad_alloc();
    if (answer == Z_STREAM_END) {
      if (inflater.is_at_end()) break;
      // RFC 1952, 2.2: members follow one another, each with the same first byte.
      constexpr char kFirstByte = 0x1F;
      if (coding != ContentCoding::gzip || packed[inflater.place()] != kFirstByte)
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
  for (const unsigned char c : text) {
    if (std::isspace(c) == 0) out += static_cast<char>(std::tolower(c));
  }
  return out;
}

/// How much each coding of an Accept-Encoding is liked, 0 to 1.
std::map<std::string, double, std::less<>> likings(std::string_view accept_encoding) {
  std::map<std::string, double, std::less<>> out;
  const std::string all = trimmed(accept_encoding) + ',';
  for (std::size_t at = 0, end = 0; (end = all.find(',', at)) != all.npos; at = end + 1) {
    const std::string one = all.substr(at, end - at);
    const std::size_t semicolon = std::min(one.find(";q="), one.size());
    const bool has_weight = semicolon < one.size();
    out[one.substr(0, semicolon)] =
        has_weight ? std::strtod(one.c_str() + semicolon + 3, nullptr) : 1;
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
  // Unnamed, identity may always be sent, and is liked less than any that is named.
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
    return Error{ErrorCode::internal, "the body needs more memory than there is"};
  }
}

std::optional<std::string> pack(ContentCoding coding, std::string_view bytes) {
  constexpr int kMemoryLevel = 8;  // zlib's default
  z_stream stream{};
  if (deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, window_bits(coding), kMemoryLevel,
                   Z_DEFAULT_STRATEGY) != Z_OK) {
    return std::nullopt;
  }
  std::optional<std::string> out;
  try {
    out.emplace(deflateBound(&stream, bytes.size()), '\0');
    stream.next_in = input_of(bytes);
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

// A compressed body: g for gzip or another letter for deflate, then the bytes.
#include "apps/service/http/content_coding.hpp"
#include "fuzz/targets.hpp"

namespace trivet::fuzz {
namespace {

using apps::service::ContentCoding;

constexpr std::size_t kMaxBytes = 1 << 16;

}  // namespace

void unpack(std::string_view input) {
  const auto coding = input.starts_with('g') ? ContentCoding::gzip : ContentCoding::deflate;
  const std::string_view packed = input.substr(std::min<std::size_t>(1, input.size()));
  (void)apps::service::accepted_coding(packed);
  const Result<std::string> bytes = apps::service::unpack(coding, packed, kMaxBytes);
  if (!bytes) return require(bytes.error().code == ErrorCode::bad_data, "faults are the client's");
  require(bytes->size() <= kMaxBytes + 1, "no more is unpacked than shows that it is too much");
  const std::optional<std::string> again = apps::service::pack(coding, *bytes);
  require(again.has_value(), "what was unpacked can be packed");
  const Result<std::string> same = apps::service::unpack(coding, *again, kMaxBytes + 1);
  require(same.has_value() && *same == *bytes, "and is the same when it is unpacked again");
}

std::vector<std::string> unpack_seeds() {
  const auto packed = [](ContentCoding coding, const std::string& text) {
    std::string input(1, coding == ContentCoding::gzip ? 'g' : 'd');
    return input.append(apps::service::pack(coding, text).value_or(""));
  };
  const std::string text = "ply\nformat ascii 1.0\n" + std::string(200, 'a');
  return {packed(ContentCoding::gzip, text),
          packed(ContentCoding::gzip, text) + packed(ContentCoding::gzip, "more").substr(1),
          packed(ContentCoding::gzip, std::string(2 * kMaxBytes, '\0')),
          packed(ContentCoding::deflate, text), "ggzip;q=0.5, deflate, *;q=0"};
}

}  // namespace trivet::fuzz

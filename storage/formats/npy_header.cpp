#include "storage/formats/npy_header.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <optional>
#include <string_view>
#include <utility>

namespace trivet::formats {
namespace {

using namespace std::string_view_literals;

constexpr std::string_view kMagic = "\x93NUMPY"sv;
constexpr std::size_t kMaxNpyHeader = 1 << 16, kMaxDimensions = 32;

/// Parser of consecutive Python literals.
class Literals {
 public:
  explicit Literals(std::string_view text) : text_(text) {}

  std::size_t position() const noexcept { return at_; }
  bool at_end() {
    skip_blanks();
    return at_ == text_.size();
  }
  /// Whether this comes next; if so, skips it.
  bool accept(std::string_view expected) {
    skip_blanks();
    if (!text_.substr(at_).starts_with(expected)) return false;
    at_ += expected.size();
    return true;
  }
  /// A string in either quotes, without escapes.
  std::optional<std::string_view> string() {
    skip_blanks();
    if (at_ == text_.size() || (text_[at_] != '\'' && text_[at_] != '"')) return {};
    const std::size_t end = text_.find(text_[at_], at_ + 1);
    if (end == text_.npos) return {};
    const auto found = text_.substr(at_ + 1, end - at_ - 1);
    at_ = end + 1;
    return found;
  }
  std::optional<bool> boolean() {
    if (accept("True")) return true;
    if (accept("False")) return false;
    return {};
  }
  /// (), (3,), (3, 4) or (3, 4,); integers may end with the L of Python 2.
  std::optional<std::vector<std::uint64_t>> tuple() {
    if (!accept("(")) return {};
    std::vector<std::uint64_t> numbers;
    while (!accept(")")) {
      skip_blanks();
      std::uint64_t number = 0;
      const char* const end = text_.data() + text_.size();
      const auto [behind, fault] = std::from_chars(text_.data() + at_, end, number);
      if (fault != std::errc{} || numbers.size() == kMaxDimensions) return {};
      at_ = static_cast<std::size_t>(behind - text_.data());
      accept("L");
      numbers.push_back(number);
      if (accept(",")) continue;
      if (numbers.size() < 2 || !accept(")")) return {};
      break;
    }
    return numbers;
  }

 private:
  void skip_blanks() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\n')) ++at_;
  }
  std::string_view text_;
  std::size_t at_ = 0;
};

struct Entries {
  std::optional<std::string_view> descr;
  std::optional<bool> fortran_order;
  std::optional<std::vector<std::uint64_t>> shape;

  bool complete() const noexcept { return descr && fortran_order && shape; }
};

/// Read one entry of the dictionary, each key once. The caller reports missing ones.
bool read_entry(Literals& text, Entries& entries) {
  const auto key = text.string();
  if (!key || !text.accept(":")) return false;
  if (*key == "descr" && !entries.descr) return (entries.descr = text.string()).has_value();
  if (*key == "fortran_order" && !entries.fortran_order)
    return (entries.fortran_order = text.boolean()).has_value();
  if (*key == "shape" && !entries.shape) return (entries.shape = text.tuple()).has_value();
  return false;
}

bool read_dictionary(Literals& text, Entries& entries) {
  if (!text.accept("{")) return false;
  while (!text.accept("}")) {
    if (!read_entry(text, entries)) return false;
    if (text.accept(",")) continue;
    if (!text.accept("}")) return false;
    break;
  }
  return entries.complete() && text.at_end();
}

struct NamedType {
  std::string_view name;  ///< type without the byte order
  Scalar type;
};
constexpr NamedType kTypes[] = {
    {"i1", Scalar::int8},    {"u1", Scalar::uint8},  {"i2", Scalar::int16}, {"u2", Scalar::uint16},
    {"i4", Scalar::int32},   {"u4", Scalar::uint32}, {"i8", Scalar::int64}, {"u8", Scalar::uint64},
    {"f4", Scalar::float32}, {"f8", Scalar::float64}};

Result<std::pair<Scalar, std::endian>> parse_type(const Input& input, std::string_view descr) {
  const std::string_view name = descr.substr(std::min<std::size_t>(1, descr.size()));
  for (const NamedType& known : kTypes) {
    if (known.name != name) continue;
    if (descr[0] == '<' || (descr[0] == '|' && size_of(known.type) == 1))
      return std::pair(known.type, std::endian::little);
    if (descr[0] == '>') return std::pair(known.type, std::endian::big);
  }
  if (name == "O") {
    return input.refuse(
        "expected an array of numbers, found Python objects, which are code and are never read; "
        "save an array of float32");
  }
  return input.refuse(
      fmt::format("expected an array of integers, float32 or float64, found the type {}; save it "
                  "with .astype(\"float32\")",
                  quote(descr)));
}

/// The text of the header, and the start of the array.
Result<std::pair<std::string_view, std::size_t>> find_header(const Input& input) {
  constexpr std::size_t kVersionBytes = 8;
  const std::string_view text = input.text();
  if (!text.starts_with(kMagic)) {
    return input.refuse("expected the signature of a NumPy array, found other bytes");
  }
  if (text.size() < kVersionBytes + 4) return input.refuse("the file is truncated in its header");
  const auto major = static_cast<unsigned char>(text[6]);
  if (major < 1 || major > 3 || text[7] != 0) {
    return input.refuse(
        fmt::format("expected version 1.0, 2.0 or 3.0 of NumPy's format, found "
                    "{}.{}",
                    major, static_cast<unsigned char>(text[7])));
  }
  const std::byte* const at = input.bytes.data() + kVersionBytes;
  const std::size_t length = major == 1 ? load<std::uint16_t>(at, std::endian::little)
                                        : load<std::uint32_t>(at, std::endian::little);
  const std::size_t begin = kVersionBytes + (major == 1 ? 2 : 4);
  if (length > kMaxNpyHeader) {
    return input.refuse(
        fmt::format("expected a header of at most {} bytes, found {}", kMaxNpyHeader, length));
  }
  if (length > text.size() - begin) {
    return input.refuse(
        fmt::format("expected a header of {} bytes, found {}; the file is truncated", length,
                    text.size() - begin));
  }
  return std::pair(text.substr(begin, length), begin + length);
}

/// Check the length of the body against type and shape.
Result<void> check_length(const Input& input, const NpyHeader& header) {
  const std::uint64_t found = input.bytes.size() - header.body_begin;
  std::uint64_t expected = size_of(header.type);
  for (const std::uint64_t side : header.shape) {
    if (side == 0) return input.refuse("the array is empty: a side of its shape is 0");
    if (side > found / expected) {
      return input.refuse(fmt::format(
          "the array has fewer bytes, {}, than its shape says; the file is truncated", found));
    }
    expected *= side;
  }
  if (expected == found) return {};
  return input.refuse(
      fmt::format("expected an array of {} bytes, found {} behind the header; the file is damaged, "
                  "or holds several arrays: save one a file",
                  expected, found));
}

}  // namespace

Result<NpyHeader> parse_npy_header(const Input& input) {
  TRIVET_TRY_ASSIGN(const auto found, find_header(input));
  Literals text(found.first);
  Entries entries;
  if (!read_dictionary(text, entries)) {
    if (entries.complete() || found.first.find("'descr': [") == std::string_view::npos) {
      return input.refuse(fmt::format(
          "byte {}: expected {{'descr': ..., 'fortran_order': ..., 'shape': (...)}}, found {}",
          found.second - found.first.size() + text.position(),
          quote(found.first.substr(text.position()))));
    }
    return input.refuse(
        "expected an array of numbers, found a structured one of named fields; if the first three "
        "are the coordinates, save numpy.stack([a[n] for n in a.dtype.names[:3]], axis=-1)");
  }
  TRIVET_TRY_ASSIGN(const auto type, parse_type(input, *entries.descr));
  NpyHeader header{type.first, type.second, *entries.fortran_order, *std::move(entries.shape),
                   found.second};
  TRIVET_TRY(check_length(input, header));
  return header;
}

}  // namespace trivet::formats

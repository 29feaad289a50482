#include "storage/formats/ply_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "storage/files/text.hpp"

namespace trivet::formats {
namespace {

constexpr std::size_t kMaxPlyHeader = 65536;

std::optional<Scalar> scalar_named(std::string_view name) noexcept {
  constexpr std::pair<std::string_view, Scalar> kTypeNames[] = {
      {"char", Scalar::int8},      {"int8", Scalar::int8},       {"uchar", Scalar::uint8},
      {"uint8", Scalar::uint8},    {"short", Scalar::int16},     {"int16", Scalar::int16},
      {"ushort", Scalar::uint16},  {"uint16", Scalar::uint16},   {"int", Scalar::int32},
      {"int32", Scalar::int32},    {"uint", Scalar::uint32},     {"uint32", Scalar::uint32},
      {"float", Scalar::float32},  {"float32", Scalar::float32}, {"double", Scalar::float64},
      {"float64", Scalar::float64}};
  for (const auto& [known, type] : kTypeNames) {
    if (name == known) return type;
  }
  return {};
}

std::optional<PlyEncoding> ply_encoding(std::string_view name) noexcept {
  if (name == "ascii") return PlyEncoding::ascii;
  if (name == "binary_little_endian") return PlyEncoding::little_endian;
  if (name == "binary_big_endian") return PlyEncoding::big_endian;
  return {};
}

/// Parse the words after "property"; empty if invalid.
std::optional<PlyProperty> parse_property(TextCursor& cursor) {
  PlyProperty property;
  std::string_view type = cursor.word();
  if (type == "list") {
    property.count_type = scalar_named(cursor.word());
    if (!property.count_type || size_of(*property.count_type) > 4) return {};
    type = cursor.word();
  }
  const auto scalar = scalar_named(type);
  property.name = cursor.word();
  if (!scalar || property.name.empty()) return {};
  property.type = *scalar;
  return property;
}

}  // namespace

const PlyElement* PlyHeader::find(std::string_view name) const noexcept {
  const auto found = std::find_if(elements.begin(), elements.end(),
                                  [&](const PlyElement& element) { return element.name == name; });
  return found == elements.end() ? nullptr : &*found;
}

Result<PlyHeader> parse_ply_header(const Input& input) {
  const std::string_view text = input.text().substr(0, kMaxPlyHeader);
  TextCursor cursor(text);
  if (const auto magic = cursor.word(); magic != "ply") {
    return input.refuse(
        fmt::format("expected a PLY file, which begins with \"ply\", found {}", quote_word(magic)));
  }

  PlyHeader header;
  bool has_format = false;
  while (cursor.next_line()) {
    const std::string_view key = cursor.word();
    const auto refuse = [&](std::string_view what) {
      return input.refuse_line(cursor.line(), what);
    };

    if (key == "format") {
      const auto name = cursor.word();
      const auto encoding = ply_encoding(name);
      if (!encoding) {
        return refuse(
            fmt::format("expected the format ascii, binary_little_endian or "
                        "binary_big_endian, found {}",
                        quote_word(name)));
      }
      header.encoding = *encoding;
      has_format = true;
    } else if (key == "element") {
      const auto name = cursor.word();
      const auto count_word = cursor.word();
      const auto count = parse_integer(count_word);
      if (name.empty() || !count || *count < 0) {
        return refuse(fmt::format("expected \"element NAME COUNT\", found {} {}", quote_word(name),
                                  quote_word(count_word)));
      }
      if (header.find(name))
        return refuse(fmt::format("element {} is declared twice", quote(name)));
      header.elements.push_back({std::string(name), static_cast<std::uint64_t>(*count), {}});
    } else if (key == "property") {
      auto property = parse_property(cursor);
      if (!property || header.elements.empty()) {
        return refuse(
            "expected \"property TYPE NAME\" or \"property list TYPE TYPE NAME\" below "
            "an element");
      }
      header.elements.back().properties.push_back(*std::move(property));
    } else if (key == "obj_info") {
      const auto name = cursor.word();
      const auto value = parse_integer(cursor.word());
      if (value && *value > 0 && name == "num_cols")
        header.num_cols = static_cast<std::uint64_t>(*value);
      if (value && *value > 0 && name == "num_rows")
        header.num_rows = static_cast<std::uint64_t>(*value);
    } else if (key == "end_header") {
      if (!has_format) return refuse("expected a line \"format ...\" in the header, found none");
      if (!cursor.next_line()) return refuse("the file ends behind the header; it is truncated");
      header.body_begin = cursor.position();
      header.body_line = cursor.line();
      return header;
    } else if (key != "comment" && !key.empty()) {
      return refuse(fmt::format("expected a line of a PLY header, found {}", quote(key)));
    }
  }
  return input.refuse(
      fmt::format("expected \"end_header\" within the first {} bytes, found none; "
                  "the file is truncated or no PLY file",
                  text.size()));
}

}  // namespace trivet::formats

#include "storage/formats/pcd_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "storage/files/text.hpp"

namespace trivet::formats {
namespace {

constexpr std::size_t kMaxPcdHeader = 65536;

/// The rest of the line as words.
std::vector<std::string_view> words_of(TextCursor& cursor) {
  std::vector<std::string_view> words;
  for (auto word = cursor.word(); !word.empty(); word = cursor.word()) words.push_back(word);
  return words;
}

std::optional<Scalar> scalar_of(std::string_view type, std::string_view size) {
  if (type == "F" && size == "4") return Scalar::float32;
  if (type == "F" && size == "8") return Scalar::float64;
  if (type != "I" && type != "U") return {};
  const bool is_signed = type == "I";
  if (size == "1") return is_signed ? Scalar::int8 : Scalar::uint8;
  if (size == "2") return is_signed ? Scalar::int16 : Scalar::uint16;
  if (size == "4") return is_signed ? Scalar::int32 : Scalar::uint32;
  if (size == "8") return is_signed ? Scalar::int64 : Scalar::uint64;
  return {};
}

/// Ignores case: some writers use capitals.
std::optional<PcdEncoding> pcd_encoding(std::string_view name) {
  const std::string lower = lower_case(name);
  if (lower == "ascii") return PcdEncoding::ascii;
  if (lower == "binary") return PcdEncoding::binary;
  if (lower == "binary_compressed") return PcdEncoding::binary_compressed;
  return {};
}

/// The words of the header's lines, unparsed.
struct Lines {
  std::vector<std::string_view> fields, sizes, types, counts, viewpoint;
  std::optional<std::int64_t> width, height, points;
  std::string_view data;
  std::size_t data_line = 0;
};

Result<void> lay_out_fields(const Input& input, const Lines& lines, PcdHeader& header) {
  const std::size_t n = lines.fields.size();
  if (n == 0 || lines.sizes.size() != n || lines.types.size() != n ||
      (!lines.counts.empty() && lines.counts.size() != n)) {
    return input.refuse(
        fmt::format("expected FIELDS, SIZE, TYPE and COUNT of equal length, found "
                    "{}, {}, {} and {} words",
                    n, lines.sizes.size(), lines.types.size(), lines.counts.size()));
  }
  for (std::size_t f = 0; f < n; ++f) {
    const auto type = scalar_of(lines.types[f], lines.sizes[f]);
    const auto count = lines.counts.empty() ? 1 : parse_integer(lines.counts[f]).value_or(-1);
    if (!type || count < 1 || count > 1'000'000) {
      return input.refuse(
          fmt::format("field {}: expected TYPE I, U or F, a SIZE of 1, 2, 4 or 8 and "
                      "a COUNT of 1 to 1000000, found {}, {} and {}",
                      quote(lines.fields[f]), quote(lines.types[f]), quote(lines.sizes[f]), count));
    }
    // No overflow: fewer than 2^15 fields of at most 2^23 bytes.
    const auto values = static_cast<std::uint64_t>(count);
    header.fields.push_back(
        {std::string(lines.fields[f]), *type, values, header.point_bytes, header.point_columns});
    header.point_bytes += values * size_of(*type);
    header.point_columns += values;
  }
  return {};
}

Result<void> set_size(const Input& input, const Lines& lines, PcdHeader& header) {
  const auto limit = static_cast<std::int64_t>(input.max_points());
  const std::int64_t height = lines.height.value_or(1);
  const std::int64_t width = lines.width.value_or(lines.points.value_or(-1));
  if (width < 0 || height < 0) {
    return input.refuse(
        "expected WIDTH, HEIGHT and POINTS to be counts, found none or less than zero");
  }
  if (width > limit) return input.refuse_count(static_cast<std::uint64_t>(width));
  if (height > limit) return input.refuse_count(static_cast<std::uint64_t>(height));
  const std::int64_t points = lines.points.value_or(width * height);
  if (points != width * height) {
    return input.refuse(fmt::format("expected POINTS to be WIDTH x HEIGHT = {} x {}, found {}",
                                    width, height, points));
  }
  if (points > limit) return input.refuse_count(static_cast<std::uint64_t>(points));
  header.width = static_cast<std::uint64_t>(width);
  header.height = static_cast<std::uint64_t>(height);
  header.num_points = static_cast<std::uint64_t>(points);
  return {};
}

Result<PcdHeader> make_header(const Input& input, const Lines& lines, const TextCursor& cursor) {
  PcdHeader header;
  TRIVET_TRY(lay_out_fields(input, lines, header));
  TRIVET_TRY(set_size(input, lines, header));

  for (std::size_t i = 0; i < 3 && i < lines.viewpoint.size(); ++i) {
    const auto number = parse_number(lines.viewpoint[i]);
    if (!number) {
      return input.refuse(
          fmt::format("VIEWPOINT: expected a number, found {}", quote(lines.viewpoint[i])));
    }
    header.viewpoint[static_cast<Eigen::Index>(i)] = *number;
  }
  if (!header.viewpoint.allFinite()) return input.refuse("VIEWPOINT: expected finite numbers");

  const auto encoding = pcd_encoding(lines.data);
  if (!encoding) {
    return input.refuse_line(
        lines.data_line, fmt::format("expected DATA ascii, binary or binary_compressed, found {}",
                                     quote_word(lines.data)));
  }
  header.encoding = *encoding;
  header.body_begin = cursor.position();
  header.body_line = cursor.line();
  return header;
}

}  // namespace

const PcdField* PcdHeader::find(std::string_view name) const noexcept {
  const auto found = std::find_if(fields.begin(), fields.end(), [&](const PcdField& field) {
    return field.name == name && field.count == 1;
  });
  return found == fields.end() ? nullptr : &*found;
}

Result<PcdHeader> parse_pcd_header(const Input& input) {
  const std::string_view text = input.text().substr(0, kMaxPcdHeader);
  TextCursor cursor(text);
  Lines lines;
  do {
    const std::string_view key = cursor.word();
    if (key == "FIELDS" || key == "COLUMNS")  // COLUMNS before version 0.7
      lines.fields = words_of(cursor);
    else if (key == "SIZE")
      lines.sizes = words_of(cursor);
    else if (key == "TYPE")
      lines.types = words_of(cursor);
    else if (key == "COUNT")
      lines.counts = words_of(cursor);
    else if (key == "VIEWPOINT")
      lines.viewpoint = words_of(cursor);
    else if (key == "WIDTH")
      lines.width = parse_integer(cursor.word()).value_or(-1);
    else if (key == "HEIGHT")
      lines.height = parse_integer(cursor.word()).value_or(-1);
    else if (key == "POINTS")
      lines.points = parse_integer(cursor.word()).value_or(-1);
    else if (key == "DATA") {
      lines.data = cursor.word();
      lines.data_line = cursor.line();
      if (!cursor.next_line())
        return input.refuse("the file ends behind the header; it is truncated");
      return make_header(input, lines, cursor);
    } else if (!key.empty() && key[0] != '#' && key != "VERSION") {
      return input.refuse_line(
          cursor.line(), fmt::format("expected a line of a PCD header, found {}", quote(key)));
    }
  } while (cursor.next_line());
  return input.refuse(
      fmt::format("expected a line \"DATA ...\" within the first {} bytes, found none; "
                  "the file is truncated or no PCD file",
                  text.size()));
}

}  // namespace trivet::formats

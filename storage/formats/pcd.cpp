#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "storage/common/stop.hpp"
#include "storage/files/text.hpp"
#include "storage/formats/intensity.hpp"
#include "storage/formats/lzf.hpp"
#include "storage/formats/pcd_header.hpp"
#include "storage/formats/positions.hpp"
#include "storage/formats/readers.hpp"

namespace trivet::formats {
namespace {

/// A requested field and its destination column.
struct Target {
  const PcdField* field;
  std::span<double> column;
};

/// Read one point per line.
Result<void> read_ascii(const Input& input, const PcdHeader& header,
                        std::span<const Target> targets) {
  std::vector<double*> column_of(header.point_columns, nullptr);
  for (const Target& target : targets) column_of[target.field->column] = target.column.data();

  TextCursor cursor(input.text().substr(header.body_begin));
  const auto refuse = [&](std::string_view expected, std::string_view found) {
    return input.refuse_line(
        header.body_line + cursor.line() - 1,
        fmt::format(
            "expected {}, found {}", expected,
            found.empty() && cursor.remaining() == 0 ? "the end of the file" : quote_word(found)));
  };
  for (std::uint64_t i = 0; i < header.num_points; ++i) {
    for (std::size_t c = 0; c < column_of.size(); ++c) {
      const auto word = c == 0 ? cursor.next_word() : cursor.word();
      const auto number = column_of[c] ? parse_number(word) : 0.0;
      if (word.empty() || !number) {
        return refuse(
            fmt::format("{} numbers as point {} of {}", column_of.size(), i, header.num_points),
            word);
      }
      if (column_of[c]) column_of[c][i] = *number;
    }
    if (const auto word = cursor.word(); !word.empty()) {
      return refuse(
          fmt::format("the end of the line behind the {} numbers of point {}", column_of.size(), i),
          word);
    }
  }
  const auto word = cursor.next_word();
  if (word.empty()) return {};
  return refuse(fmt::format("the end of the file behind {} points", header.num_points), word);
}

/// Value i of a field lies at first + i * stride.
void copy_column(const std::byte* first, std::size_t stride, const Target& target) {
  StopCheck check_stop(1 << 18);
  for (std::size_t i = 0; i < target.column.size(); ++i) {
    check_stop();
    target.column[i] = load(first + i * stride, target.field->type, std::endian::little);
  }
}

void read_binary(std::span<const std::byte> body, const PcdHeader& header,
                 std::span<const Target> targets) {
  for (const Target& target : targets) {
    copy_column(body.data() + target.field->offset, header.point_bytes, target);
  }
}

/// Header of a compressed body: an LZF stream of `packed` bytes follows, with all values of the
/// first field, then all of the second, and so on.
struct CompressedSizes {
  static constexpr std::size_t kBytes = 8;
  std::uint64_t packed, unpacked;
  explicit CompressedSizes(std::span<const std::byte> body)
      : packed(load<std::uint32_t>(body.data(), std::endian::little)),
        unpacked(load<std::uint32_t>(body.data() + 4, std::endian::little)) {}
};

Result<void> read_compressed(const Input& input, const PcdHeader& header,
                             std::span<const Target> targets) {
  const auto body = input.bytes.subspan(header.body_begin);
  const CompressedSizes sizes(body);
  std::vector<std::byte> bytes(sizes.unpacked);
  if (!decompress_lzf(body.subspan(CompressedSizes::kBytes, sizes.packed), bytes)) {
    return input.refuse_byte(
        header.body_begin,
        fmt::format("the {} compressed bytes do not unpack to {}; the file is damaged",
                    sizes.packed, sizes.unpacked));
  }
  for (const Target& target : targets) {
    copy_column(bytes.data() + target.field->offset * header.num_points,
                size_of(target.field->type), target);
  }
  return {};
}

/// PCL's colors: four bytes, the three low ones red, green and blue, declared as an integer or, by
/// custom, a float.
bool is_color(const PcdField& field) { return field.name == "rgb" || field.name == "rgba"; }

/// The intensity field. A color is read as bits, which a float could lose.
std::optional<PcdField> find_intensity(const PcdHeader& header) {
  const auto one = [](const PcdField& field) { return field.count == 1; };
  for (const PcdField& field : header.fields)
    if (one(field) && names_intensity(field.name)) return field;
  for (PcdField field : header.fields) {
    if (!one(field) || !is_color(field) || size_of(field.type) != sizeof(std::uint32_t)) continue;
    if (header.encoding != PcdEncoding::ascii) field.type = Scalar::uint32;
    return field;
  }
  return {};
}

/// Convert colors that were read as numbers to brightness.
void unpack_colors(const PcdField& field, std::span<double> values) {
  for (double& value : values) {
    const bool is_in_range = std::abs(value) < 0x1p32;
    if (field.type == Scalar::float32)
      value = brightness(std::bit_cast<std::uint32_t>(to_float(value)));
    else
      value = brightness(
          static_cast<std::uint32_t>(static_cast<std::int64_t>(is_in_range ? value : 0)));
  }
}

std::string names_of(const PcdHeader& header) {
  std::string names;
  for (const PcdField& field : header.fields)
    names += fmt::format("{}{}", names.empty() ? "" : ", ", quote(field.name));
  return names;
}

/// Check that the body can hold the announced points, before memory is allocated for them.
Result<void> check_body(const Input& input, const PcdHeader& header) {
  const auto body = input.bytes.subspan(header.body_begin);
  if (header.encoding == PcdEncoding::binary_compressed) {
    if (body.size() < CompressedSizes::kBytes) {
      return input.refuse_byte(header.body_begin,
                               "expected two sizes behind the header; the file is truncated");
    }
    const CompressedSizes sizes(body);
    if (sizes.packed > body.size() - CompressedSizes::kBytes) {
      return input.refuse_byte(
          header.body_begin,
          fmt::format("expected {} compressed bytes, found {}; the file is truncated", sizes.packed,
                      body.size() - CompressedSizes::kBytes));
    }
    // Division, as the product could overflow.
    if (sizes.unpacked / header.point_bytes != header.num_points ||
        sizes.unpacked % header.point_bytes != 0 || sizes.unpacked > sizes.packed * kMaxLzfRatio) {
      return input.refuse_byte(
          header.body_begin,
          fmt::format("expected {} points of {} bytes, found {} bytes, compressed to {}",
                      header.num_points, header.point_bytes, sizes.unpacked, sizes.packed));
    }
    return {};
  }
  // A text value takes at least a digit and a blank.
  const bool ascii = header.encoding == PcdEncoding::ascii;
  const std::uint64_t point_bytes = ascii ? 2 * header.point_columns : header.point_bytes;
  if (header.num_points > (body.size() + (ascii ? 1 : 0)) / point_bytes) {
    return input.refuse_byte(
        header.body_begin,
        fmt::format("expected {} points of {} bytes or more, found {} bytes behind the "
                    "header; the file is truncated",
                    header.num_points, point_bytes, body.size()));
  }
  return {};
}

}  // namespace

Result<Cloud> read_pcd(const Input& input) {
  TRIVET_TRY_ASSIGN(const auto header, parse_pcd_header(input));

  const std::array position{header.find("x"), header.find("y"), header.find("z")};
  const std::array normal{header.find("normal_x"), header.find("normal_y"),
                          header.find("normal_z")};
  if (!position[0] || !position[1] || !position[2]) {
    return input.refuse(fmt::format("expected the fields x, y and z with a COUNT of 1, found {}",
                                    names_of(header)));
  }
  TRIVET_TRY(check_body(input, header));

  Cloud cloud;
  Positions positions, normals;
  positions.resize(header.num_points);
  std::vector<Target> targets{
      {position[0], positions.x}, {position[1], positions.y}, {position[2], positions.z}};
  if (normal[0] && normal[1] && normal[2]) {
    normals.resize(header.num_points);
    targets.insert(targets.end(),
                   {{normal[0], normals.x}, {normal[1], normals.y}, {normal[2], normals.z}});
  }

  const std::optional<PcdField> bright =
      input.options.intensity ? find_intensity(header) : std::nullopt;
  Column<double> intensity(bright ? header.num_points : 0);
  if (bright) targets.push_back({&*bright, intensity});

  Result<void> done;
  switch (header.encoding) {
    case PcdEncoding::ascii:
      done = read_ascii(input, header, targets);
      break;
    case PcdEncoding::binary:
      read_binary(input.bytes.subspan(header.body_begin), header, targets);
      break;
    case PcdEncoding::binary_compressed:
      done = read_compressed(input, header, targets);
      break;
  }
  if (!done) return done.error();
  place(std::move(positions), input, cloud);
  cloud.normals = round_to_floats(std::move(normals));
  if (bright && is_color(*bright)) unpack_colors(*bright, intensity);
  cloud.intensity = to_floats(intensity);

  const bool organized = header.width > 1 && header.height > 1;
  if (organized) {
    cloud.grid = PixelGrid{static_cast<std::uint32_t>(header.width),
                           static_cast<std::uint32_t>(header.height),
                           Column<std::int32_t>(header.num_points)};
    std::iota(cloud.grid->point_index.begin(), cloud.grid->point_index.end(), 0);
  }
  // Zero means unknown for many writers; for an organized cloud it is the camera.
  if (organized || !header.viewpoint.isZero(0)) place_viewpoint(header.viewpoint, cloud);
  return cloud;
}

}  // namespace trivet::formats

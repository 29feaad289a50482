#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "storage/files/text.hpp"
#include "storage/formats/intensity.hpp"
#include "storage/formats/positions.hpp"
#include "storage/formats/readers.hpp"
#include "storage/formats/text_table.hpp"

namespace trivet::formats {
namespace {

using Three = std::array<std::size_t, 3>;

/// Indices of the coordinates and other requested columns.
struct Columns {
  std::size_t count = 0;
  Three position{0, 1, 2};
  std::optional<Three> normal;
  std::optional<std::size_t> intensity;
  bool named = false;
};

/// Whether points with axis-aligned normals lie on planes perpendicular to them.
bool are_faces(PointsView points, NormalsView normals) {
  constexpr std::size_t kFewest = 3;
  constexpr float kFlat = 0.01F;  // relative to the extent of all points
  using Extent = Eigen::AlignedBox3f;
  Extent all;
  std::array<Extent, 3> faces;
  std::array<std::size_t, 3> counts{};
  for (std::size_t i = 0; i < points.size(); ++i) {
    all.extend(points[i]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (normals[i][static_cast<Eigen::Index>(axis)] != 1) continue;
      faces[axis].extend(points[i]);
      ++counts[axis];
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float thickness = faces[axis].sizes()[static_cast<Eigen::Index>(axis)];
    const bool is_flat = thickness <= kFlat * all.sizes().maxCoeff();
    if (counts[axis] > 0 && (counts[axis] < kFewest || !is_flat)) return false;
  }
  return counts[0] + counts[1] + counts[2] > 0;
}

/// Whether columns four to six are directions: they may also hold colors and intensities. Values
/// that are all zero or one may be either; they are directions for flat faces.
bool are_directions(PointsView points, NormalsView normals) {
  bool all_bits = true;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const Eigen::Vector3f normal = normals[i];
    const float length = normal.norm();
    if (std::isfinite(length) && length != 0 && std::abs(length - 1) > 0.1F) return false;
    for (const float value : normal) all_bits = all_bits && (value == 0 || value == 1);
  }
  return !normals.empty() && (!all_bits || are_faces(points, normals));
}

using Names = std::array<std::string_view, 3>;
constexpr Names kPosition{"x", "y", "z"};
constexpr std::array<Names, 3> kNormals{Names{"nx", "ny", "nz"},
                                        Names{"normal_x", "normal_y", "normal_z"},
                                        Names{"normalx", "normaly", "normalz"}};

/// Start of a comment after `from`: a # without a word before it, or //.
std::size_t comment_at(std::string_view line, std::size_t from) {
  if (line.substr(from, 2) == "//") return from;
  for (std::size_t at = line.find('#', from); at != line.npos; at = line.find('#', at + 1)) {
    if (at == from || std::string_view(" \t,;").find(line[at - 1]) != line.npos) return at;
  }
  return line.size();
}

class XyzReader {
 public:
  explicit XyzReader(const Input& input) : input_(input), cursor_(input.text()) {}

  Result<Cloud> read() {
    TRIVET_TRY(read_head());
    for (bool more = has_row_; more; more = next_row()) {
      split_row(row_, delimiter_, fields_);
      TRIVET_TRY(is_count() ? begin_block() : read_point());
    }
    TRIVET_TRY(end_block());
    Cloud cloud;
    place(std::move(positions_), input_, cloud);
    const Column<float> colors = input_.options.intensity ? brightness(normals_) : Column<float>{};
    cloud.normals = round_to_floats(std::move(normals_));
    // Without names, columns four to six may also be colors, and the fourth an intensity.
    const bool directed = columns_.named || are_directions(cloud.points, cloud.normals);
    if (!directed) cloud.normals = {};
    if (columns_.intensity && (columns_.named || !directed))
      cloud.intensity = to_floats(intensity_);
    else if (!directed)
      cloud.intensity = colors;
    return cloud;
  }

 private:
  Error refuse(std::string_view what) const { return input_.refuse_line(cursor_.line(), what); }

  /// Go to the next line that is neither blank nor a comment; false at the end.
  bool next_row() {
    while (!began_ || cursor_.next_line()) {
      began_ = true;
      const auto line = cursor_.rest_of_line();
      if (line.find_first_not_of(" \t\r\n\v\f,;") == line.npos) continue;
      const auto first = line.find_first_not_of(" \t\r\n\v\f");
      row_ = line.substr(first, comment_at(line, first) - first);
      if (!row_.empty()) return true;
      const auto names = parse_names(line, find_delimiter(line));
      if (first_line_ == 0 && find_names(names, kPosition)) comment_names_ = names;
    }
    return false;
  }

  /// Whether the line is a single integer, the number of points.
  bool is_count() const {
    return fields_.size() == 1 && parse_integer(fields_[0]).value_or(-1) >= 0;
  }
  /// Whether the line is a header of words; a row that begins with a word but continues with
  /// numbers is invalid.
  bool is_header() const {
    const auto is_number = [&](std::size_t i) {
      return i < fields_.size() && parse_column(fields_[i], delimiter_);
    };
    return !is_number(0) && !fields_[0].empty() && !(is_number(1) && is_number(2));
  }

  Result<void> begin_block() {
    TRIVET_TRY(end_block());
    if (!announced_ && !positions_.size() == 0) return refuse_width();
    announced_ = parse_integer(fields_[0]);
    announced_line_ = cursor_.line();
    block_begin_ = positions_.size();
    return {};
  }
  Result<void> end_block() const {
    const auto found = static_cast<std::int64_t>(positions_.size() - block_begin_);
    if (!announced_ || *announced_ == found) return {};
    return input_.refuse_line(
        announced_line_,
        fmt::format("expected {} points as this line says, found {}", *announced_, found));
  }

  /// Skip a header and the number of points, in any order, to the first point.
  Result<void> read_head() {
    std::string_view header;
    std::size_t header_line = 0;
    while ((has_row_ = next_row())) {
      delimiter_ = find_delimiter(row_);
      split_row(row_, delimiter_, fields_);
      if (is_count()) {
        TRIVET_TRY(begin_block());
      } else if (header_line == 0 && is_header()) {
        header = row_;
        header_line = cursor_.line();
      } else {
        break;
      }
    }
    if (!has_row_) return {};
    first_line_ = cursor_.line();
    const auto names = header_line > 0 ? parse_names(header, delimiter_) : comment_names_;
    columns_.count = fields_.size();
    if (fields_.back().empty() && names.size() + 1 == columns_.count) --columns_.count;
    if (columns_.count < 3)
      return refuse(fmt::format("expected three numbers x y z, found {}", quote(row_)));
    if (columns_.count >= 6) columns_.normal = {3, 4, 5};
    // PTS format: x y z intensity, then a color.
    if (columns_.count == 4 || columns_.count == 7) set_intensity(3);
    if (set_columns_by_name(names) || header_line == 0) return {};
    // A title is not a list of names, and the names of three columns do not matter.
    const bool are_names = delimiter_ != Delimiter::blanks && names.size() == columns_.count;
    const auto position = find_names(names, kPosition);
    if (position ? *position == std::vector<std::size_t>{0, 1, 2}
                 : !are_names || columns_.count == 3)
      return {};
    return input_.refuse_line(
        header_line,
        fmt::format("expected the names of {} columns with x, y and z among them, found {}",
                    columns_.count, quote(header)));
  }

  /// Whether the names identify the coordinates.
  bool set_columns_by_name(std::span<const std::string> names) {
    const auto position = find_names(names, kPosition);
    if (names.size() != columns_.count || !position) return false;
    const auto three = [](const std::vector<std::size_t>& places) {
      return Three{places[0], places[1], places[2]};
    };
    columns_.named = true;
    columns_.position = three(*position);
    columns_.normal.reset();
    for (const Names& normal : kNormals) {
      if (const auto places = find_names(names, normal)) columns_.normal = three(*places);
    }
    columns_.intensity.reset();
    const auto bright = std::ranges::find_if(names, names_intensity);
    if (bright != names.end()) set_intensity(static_cast<std::size_t>(bright - names.begin()));
    return true;
  }

  void set_intensity(std::size_t column) {
    if (input_.options.intensity) columns_.intensity = column;
  }

  Error refuse_width() const {
    return refuse(fmt::format("expected {} columns as in line {}, found {}", columns_.count,
                              first_line_, fields_.size()));
  }

  /// Files use decimal points or decimal commas; both in one file are digit groups.
  Result<void> check_mark(std::string_view field) {
    const auto at = field.find_first_of(delimiter_ == Delimiter::commas ? "." : ".,");
    if (at == field.npos) return {};
    if (mark_ == 0) mark_ = field[at];
    if (mark_ == field[at]) return {};
    return refuse(fmt::format("expected the decimal mark of the lines above, {}, found {}",
                              quote({&mark_, 1}), quote(field)));
  }

  Result<Eigen::Vector3d> read_three(const Three& columns, std::string_view what) {
    Eigen::Vector3d values;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto field = fields_[columns[i]];
      const auto number = parse_column(field, delimiter_);
      if (!number) {
        return refuse(fmt::format("expected a number as {} in column {}, found {}", what[i],
                                  columns[i] + 1,
                                  field.empty() ? "an empty column" : quote(field)));
      }
      TRIVET_TRY(check_mark(field));
      values[static_cast<Eigen::Index>(i)] = *number;
    }
    return values;
  }

  Result<void> read_point() {
    // A delimiter after the last column adds no column.
    if (fields_.size() == columns_.count + 1 && fields_.back().empty()) fields_.pop_back();
    if (fields_.size() != columns_.count) return refuse_width();
    if (positions_.size() == input_.max_points()) return input_.refuse_count(positions_.size() + 1);

    TRIVET_TRY_ASSIGN(const auto point, read_three(columns_.position, "xyz"));
    positions_.push_back(point);
    if (columns_.intensity) {
      constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
      intensity_.push_back(parse_column(fields_[*columns_.intensity], delimiter_).value_or(kNone));
    }
    if (!columns_.normal) return {};
    const auto normal = read_three(*columns_.normal, "xyz");
    if (!normal && columns_.named) return normal.error();
    if (normal) {
      normals_.push_back(*normal);
    } else {  // words in columns four to six
      columns_.normal.reset();
      normals_ = {};
    }
    return {};
  }

  const Input& input_;
  TextCursor cursor_;
  Positions positions_, normals_;
  Column<double> intensity_;
  Columns columns_;
  Delimiter delimiter_ = Delimiter::blanks;
  std::vector<std::string_view> fields_;
  std::string_view row_;
  std::vector<std::string> comment_names_;  // names in a comment before the points
  bool began_ = false, has_row_ = false;
  char mark_ = 0;  // decimal mark, once seen
  std::size_t first_line_ = 0, announced_line_ = 0, block_begin_ = 0;
  std::optional<std::int64_t> announced_;
};

}  // namespace

Result<Cloud> read_xyz(const Input& input) { return XyzReader(input).read(); }

}  // namespace trivet::formats

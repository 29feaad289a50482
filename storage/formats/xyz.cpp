#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>

#include "storage/files/text.hpp"
#include "storage/formats/readers.hpp"

namespace trivet::formats {
namespace {

constexpr std::size_t kMaxColumns = 6;

/// The first columns of a line, up to a comment.
struct Row {
  std::array<double, kMaxColumns> values{};
  std::size_t size = 0;
  std::string_view fault;  ///< the word that is no number, if any stopped the row
};

Row read_row(TextCursor& cursor) {
  Row row;
  while (row.size < kMaxColumns) {
    const auto word = cursor.word();
    if (word.empty() || word[0] == '#') break;
    const auto number = parse_number(word);
    if (!number) {
      row.fault = word;
      break;
    }
    row.values[row.size++] = *number;
  }
  return row;
}

/// Whether columns four to six are directions: colors and intensities stand there as well.
bool are_directions(PointsView normals) {
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const float length = normals[i].norm();
    if (std::isfinite(length) && length != 0 && std::abs(length - 1) > 0.1F) return false;
  }
  return true;
}

}  // namespace

Result<Cloud> read_xyz(const Input& input) {
  TextCursor cursor(input.text(), ",;");
  Cloud cloud;
  bool with_normals = false, header_allowed = true;
  do {
    const Row row = read_row(cursor);
    if (row.size == 0 && row.fault.empty()) continue;  // blank or comment
    if (row.size < 3) {
      if (std::exchange(header_allowed, false)) continue;
      return input.refuse_line(
          cursor.line(), fmt::format("expected three numbers x y z, found {} and then {}", row.size,
                                     row.fault.empty() ? "the end of the line" : quote(row.fault)));
    }
    header_allowed = false;
    if (cloud.points.size() == input.max_points())
      return input.refuse_count(cloud.points.size() + 1);
    const auto at = [&](std::size_t column) { return to_float(row.values[column]); };
    if (cloud.points.empty()) with_normals = row.size == kMaxColumns;
    if (with_normals && row.size < kMaxColumns) {
      return input.refuse_line(
          cursor.line(),
          fmt::format("expected six numbers as in the lines above, found {}", row.size));
    }
    cloud.points.push_back({at(0), at(1), at(2)});
    if (with_normals) cloud.normals.push_back({at(3), at(4), at(5)});
  } while (cursor.next_line());

  if (!are_directions(cloud.normals)) cloud.normals = {};
  return cloud;
}

}  // namespace trivet::formats

#include "storage/files/nearest_name.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "storage/common/valid_text.hpp"

namespace trivet {
namespace {

/// Longer names are not typing errors and cost no time.
constexpr std::size_t kMostLetters = 64;

/// The significant characters of a name, without case.
std::string folded(std::string_view name) {
  std::string out;
  for (const char c : name) {
    if (c != '-' && c != '_' && c != ' ')
      out += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return out;
}

std::size_t num_differing(std::string_view a, std::string_view b) {
  // Rows of the distance table between prefixes of both: two before, one before, current.
  std::array<std::vector<std::size_t>, 3> rows;
  for (auto& row : rows) row.resize(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) rows[2][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::rotate(rows.begin(), rows.begin() + 1, rows.end());
    const auto& [before, above, unused] = rows;
    auto& row = rows[2];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = above[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, replaced});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return rows[2][b.size()];
}

}  // namespace

std::string_view nearest_name(std::string_view name, std::span<const std::string_view> known) {
  if (name.size() > kMostLetters) return {};
  const std::string found = folded(name);
  std::string_view nearest;
  std::size_t least = found.size() / 3 + 1;  // smaller distances are near
  for (const std::string_view one : known) {
    const std::size_t differing = num_differing(found, folded(one));
    if (differing < least) {
      least = differing;
      nearest = one;
    }
  }
  return nearest;
}

std::string unknown_name(std::string_view name, std::span<const std::string_view> known) {
  const std::string found = printable(name.substr(0, kMostLetters));
  const std::string_view nearest = nearest_name(name, known);
  return nearest.empty()
             ? fmt::format("expected one of {}, found '{}'", fmt::join(known, ", "), found)
             : fmt::format("found '{}'; did you mean '{}'?", found, nearest);
}

}  // namespace trivet

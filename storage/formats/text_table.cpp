#include "storage/formats/text_table.hpp"

#include <algorithm>

#include "storage/files/text.hpp"

namespace trivet::formats {
namespace {

constexpr std::size_t kMaxColumns = 1000;
constexpr std::string_view kBlanks = " \t\r\n\v\f";

std::string_view trim(std::string_view text, std::string_view around = kBlanks) {
  const std::size_t first = text.find_first_not_of(around);
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(around) - first + 1);
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Whether the word has one comma, between digits or at the start, and no point.
bool has_decimal_comma(std::string_view word) {
  const std::size_t comma = word.find(',');
  return comma != word.npos && comma + 1 < word.size() && is_digit(word[comma + 1]) &&
         word.find(',', comma + 1) == word.npos && word.find('.') == word.npos;
}

void split_at_blanks(std::string_view row, std::vector<std::string_view>& columns) {
  std::size_t at = row.find_first_not_of(kBlanks);
  while (at != row.npos && columns.size() < kMaxColumns) {
    const std::size_t end = std::min(row.find_first_of(kBlanks, at), row.size());
    columns.push_back(row.substr(at, end - at));
    at = row.find_first_not_of(kBlanks, end);
  }
}

}  // namespace

Delimiter find_delimiter(std::string_view row) {
  if (row.find(';') != row.npos) return Delimiter::semicolons;
  if (row.find(',') == row.npos) return Delimiter::blanks;
  std::vector<std::string_view> words;
  split_at_blanks(row, words);
  const bool are_decimal = std::all_of(words.begin(), words.end(), [](std::string_view word) {
    return word.find(',') == word.npos || has_decimal_comma(word);
  });
  return words.size() >= 3 && are_decimal ? Delimiter::blanks : Delimiter::commas;
}

void split_row(std::string_view row, Delimiter delimiter, std::vector<std::string_view>& columns) {
  columns.clear();
  if (delimiter == Delimiter::blanks) return split_at_blanks(row, columns);
  const char between = delimiter == Delimiter::commas ? ',' : ';';
  for (std::size_t at = 0; at <= row.size() && columns.size() < kMaxColumns;) {
    const std::size_t end = std::min(row.find(between, at), row.size());
    std::string_view column = trim(row.substr(at, end - at));
    if (column.size() >= 2 && column.front() == '"' && column.back() == '"')
      column = trim(column.substr(1, column.size() - 2));
    columns.push_back(column);
    at = end + 1;
  }
}

std::optional<double> parse_column(std::string_view column, Delimiter delimiter) {
  if (delimiter == Delimiter::commas || !has_decimal_comma(column)) return parse_number(column);
  std::string with_point(column);
  with_point[column.find(',')] = '.';
  return parse_number(with_point);
}

std::vector<std::string> parse_names(std::string_view header, Delimiter delimiter) {
  std::vector<std::string_view> columns;
  split_row(trim(header, " \t\r#/"), delimiter, columns);
  std::vector<std::string> names;
  names.reserve(columns.size());
  for (const std::string_view column : columns) {
    names.push_back(lower_case(trim(column.substr(0, column.find_first_of("[(")), " \t\"'")));
  }
  return names;
}

std::optional<std::vector<std::size_t>> find_names(std::span<const std::string> names,
                                                   std::span<const std::string_view> wanted) {
  std::vector<std::size_t> places;
  for (const std::string_view name : wanted) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) return {};
    places.push_back(static_cast<std::size_t>(found - names.begin()));
  }
  return places;
}

}  // namespace trivet::formats

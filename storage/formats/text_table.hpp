/// Rows and columns of text: one row per line; columns are separated by commas, by semicolons or by
/// blanks, the same in all rows.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace trivet::formats {

/// Separator of the columns of a row.
enum class Delimiter { blanks, commas, semicolons };

/// Detect the delimiter of a row of numbers. Commas are decimal marks if something else separates
/// the columns ("1,5 2,25 0"); those of "1,5,2" separate columns.
Delimiter find_delimiter(std::string_view row);

/// Split a row into columns without surrounding blanks and quotes. Between commas or semicolons a
/// column may be empty, also the last one. Columns beyond 1000 are dropped.
void split_row(std::string_view row, Delimiter delimiter, std::vector<std::string_view>& columns);

/// Parse a column as a number. Unless commas are the delimiter, a comma in it is a decimal mark.
std::optional<double> parse_column(std::string_view column, Delimiter delimiter);

/// The names of a header in lower case, without their units: "//X [m]; Y [m]" gives "x", "y".
std::vector<std::string> parse_names(std::string_view header, Delimiter delimiter);

/// Indices of the columns with these names; empty unless all are present.
std::optional<std::vector<std::size_t>> find_names(std::span<const std::string> names,
                                                   std::span<const std::string_view> wanted);

}  // namespace trivet::formats

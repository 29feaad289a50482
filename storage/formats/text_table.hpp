/// Rows and columns of text: one row a line; columns stand between commas, between semicolons, or
/// between blanks, the same in all rows.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace trivet::formats {

/// What stands between the columns of a row.
enum class Delimiter { blanks, commas, semicolons };

/// Tell the delimiter of a row of numbers. Commas are decimal where something else parts the
/// columns ("1,5 2,25 0"); those of "1,5,2" part columns.
Delimiter find_delimiter(std::string_view row);

/// Split a row into its columns without the blanks and quotes around them; between commas or
/// semicolons a column may be empty, also the last one. More than 1000 columns are cut.
void split_row(std::string_view row, Delimiter delimiter, std::vector<std::string_view>& columns);

/// A column as a number. Unless commas are the delimiter, one in it is a decimal mark.
std::optional<double> parse_column(std::string_view column, Delimiter delimiter);

/// The names of a header in lower case, without their units: "//X [m]; Y [m]" gives "x", "y".
std::vector<std::string> parse_names(std::string_view header, Delimiter delimiter);

/// Where columns of these names stand; none unless all are there.
std::optional<std::vector<std::size_t>> find_names(std::span<const std::string> names,
                                                   std::span<const std::string_view> wanted);

}  // namespace trivet::formats

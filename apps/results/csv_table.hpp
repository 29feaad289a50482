/// CSV tables after RFC 4180, for spreadsheets and statistics programs.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "storage/common/result.hpp"

namespace trivet::apps {

/// Builds a table row by row.
class CsvTable {
 public:
  explicit CsvTable(std::string_view header) : text_(header) {}

  CsvTable& row();
  CsvTable& text(std::string_view bytes);  ///< converted by valid_utf8()
  /// Appends a number with seven digits; an empty field if it is not finite.
  CsvTable& number(double value);
  CsvTable& number(const std::optional<double>& value);
  CsvTable& count(std::size_t value);
  CsvTable& empty(std::size_t fields);
  std::string whole() const { return text_ + '\n'; }
  /// Writes the file atomically: it appears whole or not at all. Errors: cannot_create, io.
  Result<void> write(const std::filesystem::path& file) const;

 private:
  void separate();
  std::string text_;
  bool first_ = true;
};

}  // namespace trivet::apps

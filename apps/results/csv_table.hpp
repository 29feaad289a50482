/// Tables for spreadsheets and statistics programs, after RFC 4180.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "storage/common/result.hpp"

namespace trivet::apps {

/// A table under construction, row by row.
class CsvTable {
 public:
  explicit CsvTable(std::string_view header) : text_(header) {}

  CsvTable& row();
  CsvTable& text(std::string_view bytes);  ///< as valid_utf8() tells it
  /// To seven digits; one that is not finite is empty.
  CsvTable& number(double value);
  CsvTable& number(const std::optional<double>& value);
  CsvTable& count(std::size_t value);
  CsvTable& empty(std::size_t fields);
  /// The file appears whole or not at all. Errors: cannot_create, io.
  Result<void> write(const std::filesystem::path& file) const;

 private:
  void separate();
  std::string text_;
  bool first_ = true;
};

}  // namespace trivet::apps

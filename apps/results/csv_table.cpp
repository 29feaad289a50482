#include "apps/results/csv_table.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <span>
#include <string>

#include "storage/common/valid_text.hpp"
#include "storage/files/file.hpp"

namespace trivet::apps {

CsvTable& CsvTable::row() {
  text_ += '\n';
  first_ = true;
  return *this;
}

CsvTable& CsvTable::text(std::string_view bytes) {
  separate();
  const std::string value = valid_utf8(bytes);
  if (value.find_first_of(",\"\r\n") == std::string_view::npos) {
    text_ += value;
    return *this;
  }
  text_ += '"';
  for (const char c : value) text_ += c == '"' ? std::string("\"\"") : std::string(1, c);
  text_ += '"';
  return *this;
}

CsvTable& CsvTable::number(double value) {
  separate();
  if (std::isfinite(value)) fmt::format_to(std::back_inserter(text_), "{:.7g}", value);
  return *this;
}

CsvTable& CsvTable::number(const std::optional<double>& value) {
  return number(value.value_or(std::nan("")));
}

CsvTable& CsvTable::count(std::size_t value) {
  separate();
  fmt::format_to(std::back_inserter(text_), "{}", value);
  return *this;
}

CsvTable& CsvTable::empty(std::size_t fields) {
  for (std::size_t i = 0; i < fields; ++i) separate();
  return *this;
}

Result<void> CsvTable::write(const std::filesystem::path& file) const {
  const std::string table = whole();
  return publish_file(file, std::as_bytes(std::span(table)));
}

void CsvTable::separate() {
  if (!first_) text_ += ',';
  first_ = false;
}

}  // namespace trivet::apps

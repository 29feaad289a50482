/// Parsing of numbers, independent of the locale of the process.
#pragma once

#include <locale.h>  // locale_t is POSIX

#include <cstdint>
#include <optional>
#include <string_view>

namespace trivet {

/// Parse a whole word as a number; "nan" and "inf" are numbers. Empty beyond the range of double.
std::optional<double> parse_number(std::string_view word) noexcept;
std::optional<std::int64_t> parse_integer(std::string_view word) noexcept;

/// Round to float; finite values beyond its range stay finite, so that they differ from infinity.
float to_float(double value) noexcept;

/// A value as an index below `bound`; empty if it is negative, not an integer or too large.
std::optional<std::uint32_t> to_index(double value, std::uint64_t bound) noexcept;

/// While it lives, the C library formats and parses numbers on this thread in the C locale: for
/// third-party code that depends on the locale.
class PlainLocale {
 public:
  PlainLocale() noexcept;
  PlainLocale(const PlainLocale&) = delete;
  PlainLocale& operator=(const PlainLocale&) = delete;
  ~PlainLocale();

 private:
  locale_t before_;
};

}  // namespace trivet

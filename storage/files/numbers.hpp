/// Numbers from text: the one way in which they are read, whatever the locale of the process.
#pragma once

#include <locale.h>  // locale_t is of POSIX

#include <cstdint>
#include <optional>
#include <string_view>

namespace trivet {

/// A whole word as a number; "nan" and "inf" are numbers. Beyond the range of double: none.
std::optional<double> parse_number(std::string_view word) noexcept;
std::optional<std::int64_t> parse_integer(std::string_view word) noexcept;

/// Round to float; finite values beyond its range stay finite, so that they can be told from
/// infinity.
float to_float(double value) noexcept;

/// A value as an index below `bound`; none when it is negative, broken or too large.
std::optional<std::uint32_t> to_index(double value, std::uint64_t bound) noexcept;

/// While it lives, the C library writes and reads numbers in this thread as the C locale has it:
/// for code of others that asks the locale.
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

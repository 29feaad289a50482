#include "storage/files/numbers.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>

namespace trivet {
namespace {

/// std::from_chars does not accept a plus sign.
std::string_view without_plus(std::string_view word) noexcept {
  const bool plus = word.size() > 1 && word[0] == '+' && word[1] != '-';
  return plus ? word.substr(1) : word;
}

}  // namespace

std::optional<double> parse_number(std::string_view word) noexcept {
  word = without_plus(word);
  double value = 0;
  const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size()) return {};
  if (fault == std::errc{}) return value;
  // Values too small for double are zero, too large ones are invalid.
  const bool tiny = word.find("e-") != word.npos || word.find("E-") != word.npos;
  if (fault == std::errc::result_out_of_range && tiny) return 0.0;
  return {};
}

std::optional<std::int64_t> parse_integer(std::string_view word) noexcept {
  word = without_plus(word);
  std::int64_t value = 0;
  const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (fault != std::errc{} || end != word.data() + word.size()) return {};
  return value;
}

float to_float(double value) noexcept {
  constexpr double kLargest = std::numeric_limits<float>::max();
  return static_cast<float>(std::isfinite(value) ? std::clamp(value, -kLargest, kLargest) : value);
}

std::optional<std::uint32_t> to_index(double value, std::uint64_t bound) noexcept {
  const double limit = std::min(static_cast<double>(bound), 4294967296.0);
  if (!(value >= 0 && value < limit) || value != std::floor(value)) return {};
  return static_cast<std::uint32_t>(value);
}

PlainLocale::PlainLocale() noexcept {
  static const locale_t kPlain = ::newlocale(LC_ALL_MASK, "C", nullptr);  // never freed
  before_ = ::uselocale(kPlain);
}

PlainLocale::~PlainLocale() { ::uselocale(before_); }

}  // namespace trivet

#include "engine/options/option.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/options/declare_option.hpp"
#include "storage/files/numbers.hpp"

namespace trivet {
namespace {

std::vector<std::string_view> split(std::string_view text) {
  std::vector<std::string_view> parts;
  while (!text.empty()) {
    const std::size_t comma = std::min(text.find(','), text.size());
    parts.push_back(text.substr(0, comma));
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
  return parts;
}

std::vector<std::string_view> names_of(std::span<const Choice> choices) {
  std::vector<std::string_view> names;
  for (const Choice& choice : choices) names.push_back(choice.name);
  return names;
}

std::size_t most_numbers(const OptionInfo& info) { return std::max(info.length, info.max_length); }

std::string kind_text(const OptionInfo& info) {
  switch (info.kind) {
    case OptionKind::flag:
      return "true or false";
    case OptionKind::number:
      return info.automatic ? "a number or \"auto\"" : "a number";
    case OptionKind::count:
      return "a whole number";
    case OptionKind::choice:
      return range_text(info);
    case OptionKind::numbers:
      return most_numbers(info) > info.length
                 ? fmt::format("{} or {} numbers", info.length, most_numbers(info))
                 : fmt::format("{} numbers", info.length);
    case OptionKind::names:
      return info.choices.empty() ? "names" : range_text(info);
  }
  return {};
}

Error wrong(std::string_view expected, std::string_view found) {
  return {ErrorCode::usage, fmt::format("expected {}, found {}", expected, found)};
}

bool read_number(std::string_view text, double& number) {
  const std::optional<double> read = parse_number(text);
  number = read.value_or(std::nan(""));
  return !std::isnan(number);
}

bool is_chosen(std::span<const Choice> choices, std::string_view name) {
  return choices.empty() || std::ranges::find(choices, name, &Choice::name) != choices.end();
}

bool is_within(const OptionInfo& info, double number) {
  const OptionRange& range = info.range;
  if (info.kind == OptionKind::count && std::floor(number) != number) return false;
  return number <= range.high && (range.above_low ? number > range.low : number >= range.low);
}

}  // namespace

Error named(const OptionInfo& info, const Error& error) {
  return {error.code, fmt::format("{}: {}", info.name, error.message)};
}

namespace engine {

double decimal_of(float field) {
  return parse_number(fmt::format("{}", field)).value_or(static_cast<double>(field));
}

}  // namespace engine

std::string value_text(const OptionValue& value) {
  if (const bool* const flag = std::get_if<bool>(&value)) return *flag ? "yes" : "no";
  if (const double* const number = std::get_if<double>(&value)) return fmt::format("{:g}", *number);
  if (const std::string* const text = std::get_if<std::string>(&value)) return *text;
  if (const auto* const numbers = std::get_if<std::vector<double>>(&value))
    return numbers->empty() ? "none" : fmt::format("{:g}", fmt::join(*numbers, ", "));
  const auto& names = std::get<std::vector<std::string>>(value);
  return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
}

bool is_unset(const OptionValue& value) {
  if (const double* const number = std::get_if<double>(&value)) return !std::isfinite(*number);
  if (const std::string* const text = std::get_if<std::string>(&value)) return *text == "auto";
  if (const auto* const numbers = std::get_if<std::vector<double>>(&value)) return numbers->empty();
  const auto* const names = std::get_if<std::vector<std::string>>(&value);
  return names && names->empty();
}

std::string option_text(const OptionInfo& info, const OptionValue& value) {
  return is_unset(value) && !info.unset_help.empty() ? std::string(info.unset_help)
                                                     : value_text(value);
}

std::string label_with_unit(const OptionInfo& info) {
  return info.unit.empty() ? std::string(info.label)
                           : fmt::format("{} [{}]", info.label, info.unit);
}

std::string range_text(const OptionInfo& info) {
  if (!info.choices.empty()) {
    return fmt::format("{} {}", info.kind == OptionKind::names ? "some of" : "one of",
                       fmt::join(names_of(info.choices), ", "));
  }
  const OptionRange& range = info.range;
  const char* const above = range.above_low ? "above " : "";
  // Upper end that a reader takes as unbounded.
  constexpr double kUnbounded = std::numeric_limits<std::uint32_t>::max();
  if (std::isfinite(range.low) && range.high < kUnbounded)
    return fmt::format("{}{:g} to {:.10g}", above, range.low, range.high);
  if (std::isfinite(range.low) && (range.low > 0 || range.above_low))
    return fmt::format("{}{:g}", range.above_low ? "above " : "at least ", range.low);
  return {};
}

Result<OptionValue> parse_option(const OptionInfo& info, std::string_view text) {
  double number = 0;
  switch (info.kind) {
    case OptionKind::flag:
      if (text.empty() || text == "true") return OptionValue(true);
      if (text == "false") return OptionValue(false);
      break;
    case OptionKind::number:
    case OptionKind::count:
      if (info.automatic && text == "auto") return OptionValue(std::string(text));
      if (read_number(text, number)) return OptionValue(number);
      break;
    case OptionKind::choice:
      return OptionValue(std::string(text));
    case OptionKind::numbers: {
      std::vector<double> numbers;
      for (const std::string_view part : split(text)) {
        if (!read_number(part, numbers.emplace_back())) return wrong(kind_text(info), text);
      }
      return OptionValue(std::move(numbers));
    }
    case OptionKind::names: {
      std::vector<std::string> names;
      for (const std::string_view part : split(text)) names.emplace_back(part);
      return OptionValue(std::move(names));
    }
  }
  return wrong(kind_text(info), fmt::format("'{}'", text));
}

Result<void> check_option(const OptionInfo& info, const OptionValue& value) {
  const std::string found = value_text(value);
  switch (info.kind) {
    case OptionKind::flag:
      if (std::holds_alternative<bool>(value)) return {};
      break;
    case OptionKind::number:
    case OptionKind::count: {
      if (info.automatic && value == OptionValue(std::string("auto"))) return {};
      const double* const number = std::get_if<double>(&value);
      if (!number) break;
      if (is_within(info, *number)) return {};
      const std::string range = range_text(info);
      if (range.empty()) return wrong(kind_text(info), found);
      return wrong(info.unit.empty() ? range : fmt::format("{} [{}]", range, info.unit), found);
    }
    case OptionKind::choice: {
      const std::string* const name = std::get_if<std::string>(&value);
      if (name && is_chosen(info.choices, *name)) return {};
      break;
    }
    case OptionKind::numbers: {
      const auto* const numbers = std::get_if<std::vector<double>>(&value);
      if (numbers && (numbers->empty() ||
                      (numbers->size() >= info.length && numbers->size() <= most_numbers(info))))
        return {};
      break;
    }
    case OptionKind::names: {
      const auto* const names = std::get_if<std::vector<std::string>>(&value);
      if (!names) break;
      const auto unknown = std::ranges::find_if(
          *names, [&](const std::string& name) { return !is_chosen(info.choices, name); });
      if (unknown == names->end()) return {};
      return wrong(kind_text(info), *unknown);
    }
  }
  return wrong(kind_text(info), found);
}

}  // namespace trivet

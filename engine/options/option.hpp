/// Options that are declared once: the command line, the service, studies, reports and libraries
/// name, describe, check, set and tell them by these declarations.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "storage/common/result.hpp"

namespace trivet {

/// One of the values of an enumeration, or of the names that a list may hold.
struct Choice {
  std::string_view name;
  std::string_view sentence{};  ///< what it means, where the name does not say it
};

/// The choices of an enumeration, in the order of its values from 0 on.
template <class Enum>
std::span<const Choice> choices_of();

/// A value's name among the choices.
template <class Enum>
std::string_view choice_name(Enum value) {
  return choices_of<Enum>()[static_cast<std::size_t>(value)].name;
}

/// The text "auto" stands for a number that the program chooses by itself.
using OptionValue =
    std::variant<bool, double, std::string, std::vector<double>, std::vector<std::string>>;

/// As a person would write it: "0.04", "yes", "a, b", "none".
std::string value_text(const OptionValue& value);

/// Whether it leaves the choice open: "auto", infinity, nothing listed.
bool is_unset(const OptionValue& value);

/// What values an option has.
enum class OptionKind : std::uint8_t {
  flag,     ///< bool
  number,   ///< double
  count,    ///< double without a fraction
  choice,   ///< string, one of the choices
  numbers,  ///< vector<double> of `length`, or empty: not set
  names,    ///< vector<string>, of the choices if there are any
};

/// What numbers may be, both ends included.
struct OptionRange {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool above_low = false;  ///< the low end itself is too low
};

/// Where an option can be given; reports and libraries tell all.
enum class OptionPlace : std::uint8_t { anywhere, not_in_studies, service_only };

/// What can be said of an option without its options.
struct OptionInfo {
  std::string_view name;   ///< of the flag, the parameter of a query, the setting of a study
  std::string_view group;  ///< heading that it stands below
  std::string_view label;  ///< what it is in a few words, for tables and charts
  std::string_view unit{};
  std::string_view help;          ///< a sentence without range and default
  std::string_view unset_help{};  ///< what "auto" or an unset value means
  OptionRange range{};
  std::size_t length = 0;      ///< of numbers
  std::size_t max_length = 0;  ///< where they may be more
  OptionPlace place = OptionPlace::anywhere;
  OptionKind kind{};                  ///< of the field
  bool automatic = false;             ///< may be "auto"
  std::span<const Choice> choices{};  ///< of a choice or of names; none: any name
};

/// The value, or what it means that it is unset.
std::string option_text(const OptionInfo& info, const OptionValue& value);

/// "tolerance [diameter]"
std::string label_with_unit(const OptionInfo& info);

/// "above 0 to 1", "at least 1", "one of a, b"; empty: anything of its kind.
std::string range_text(const OptionInfo& info);

/// What a text says, by the kind of the option. Lists are separated by commas; an empty text is
/// true for a flag. Errors: usage (what was expected).
Result<OptionValue> parse_option(const OptionInfo& info, std::string_view text);

/// Errors: usage (range and value).
Result<void> check_option(const OptionInfo& info, const OptionValue& value);

/// The error with the name of its option.
Error named(const OptionInfo& info, const Error& error);

/// An option, and the field of its options that it stands for.
template <class Options>
struct Option {
  OptionInfo info;
  OptionValue (*get)(const Options&);
  /// Pre: check_option() of the value.
  void (*set)(Options&, const OptionValue&);
};

/// The list of each kind of options; specialized beside their declaration.
template <class Options>
std::span<const Option<Options>> options_of();

/// None of this name: null.
template <class Options>
const Option<Options>* find_option(std::string_view name) {
  for (const Option<Options>& option : options_of<Options>()) {
    if (option.info.name == name) return &option;
  }
  return nullptr;
}

/// Their names, in their order.
template <class Options>
std::vector<std::string_view> option_names() {
  std::vector<std::string_view> names;
  for (const Option<Options>& option : options_of<Options>()) names.push_back(option.info.name);
  return names;
}

/// Set an option to what a text says. Errors: usage (name, range and value).
template <class Options>
Result<void> set_option(const Option<Options>& option, std::string_view text, Options& options) {
  const Result<OptionValue> value = parse_option(option.info, text);
  if (!value) return named(option.info, value.error());
  const Result<void> valid = check_option(option.info, *value);
  if (!valid) return named(option.info, valid.error());
  option.set(options, *value);
  return {};
}

/// Errors: usage (name, range and value), of the first value that is out of range.
template <class Options>
Result<void> check_options(const Options& options) {
  for (const Option<Options>& option : options_of<Options>()) {
    const Result<void> valid = check_option(option.info, option.get(options));
    if (!valid) return named(option.info, valid.error());
  }
  return {};
}

}  // namespace trivet

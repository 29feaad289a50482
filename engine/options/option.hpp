/// Options that are declared once. The command line, the service, studies, reports and libraries
/// use these declarations to name, describe, check, set and report them.
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

/// One value of an enumeration, or one name that a list may contain.
struct Choice {
  std::string_view name;
  std::string_view sentence{};  ///< meaning, if the name does not express it
};

/// The choices of an enumeration, in the order of its values from 0 on.
template <class Enum>
std::span<const Choice> choices_of();

/// A value's name among the choices.
template <class Enum>
std::string_view choice_name(Enum value) {
  return choices_of<Enum>()[static_cast<std::size_t>(value)].name;
}

/// The text "auto" represents a number that the program chooses by itself.
using OptionValue =
    std::variant<bool, double, std::string, std::vector<double>, std::vector<std::string>>;

/// Text as a person would write it: "0.04", "yes", "a, b", "none".
std::string value_text(const OptionValue& value);

/// Whether the value leaves the choice open: "auto", infinity or an empty list.
bool is_unset(const OptionValue& value);

/// Kinds of option values.
enum class OptionKind : std::uint8_t {
  flag,     ///< bool
  number,   ///< double
  count,    ///< double without a fraction
  choice,   ///< string, one of the choices
  numbers,  ///< vector<double> of `length` numbers, or empty if not set
  names,    ///< vector<string>; only names among the choices if there are any
};

/// Valid range of a number, both ends included.
struct OptionRange {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool above_low = false;  ///< whether the low end itself is invalid
};

/// Places where an option can be given. Reports and libraries list all options.
enum class OptionPlace : std::uint8_t { anywhere, not_in_studies, service_only };

/// Properties of an option that do not depend on the type of its options.
struct OptionInfo {
  std::string_view name;   ///< name of the flag, of the query parameter and of the study setting
  std::string_view group;  ///< heading above the option in lists
  std::string_view label;  ///< meaning in a few words, for tables and charts
  std::string_view unit{};
  std::string_view help;          ///< one sentence without range and default
  std::string_view unset_help{};  ///< meaning of "auto" or of an unset value
  OptionRange range{};
  std::size_t length = 0;      ///< length of a list of numbers
  std::size_t max_length = 0;  ///< maximum length, if lists may be longer than `length`
  OptionPlace place = OptionPlace::anywhere;
  OptionKind kind{};                  ///< kind of the field
  bool automatic = false;             ///< whether the value may be "auto"
  std::span<const Choice> choices{};  ///< choices of a choice or of names; empty: any name
};

/// The value as text, or the meaning of an unset value.
std::string option_text(const OptionInfo& info, const OptionValue& value);

/// Label and unit: "tolerance [diameter]".
std::string label_with_unit(const OptionInfo& info);

/// Range as text: "above 0 to 1", "at least 1", "one of a, b". Empty: any value of the kind is
/// valid.
std::string range_text(const OptionInfo& info);

/// Parse a text as a value of the option's kind. Lists are separated by commas; an empty text is
/// true for a flag. Errors: usage (what was expected).
Result<OptionValue> parse_option(const OptionInfo& info, std::string_view text);

/// Check a value against the option's range. Errors: usage (range and value).
Result<void> check_option(const OptionInfo& info, const OptionValue& value);

/// The error, with the name of its option added.
Error named(const OptionInfo& info, const Error& error);

/// An option together with the field that stores it.
template <class Options>
struct Option {
  OptionInfo info;
  OptionValue (*get)(const Options&);
  /// Pre: check_option() accepts the value.
  void (*set)(Options&, const OptionValue&);
};

/// The list of all options of a type; specialized next to their declarations.
template <class Options>
std::span<const Option<Options>> options_of();

/// The option with this name; null if there is none.
template <class Options>
const Option<Options>* find_option(std::string_view name) {
  for (const Option<Options>& option : options_of<Options>()) {
    if (option.info.name == name) return &option;
  }
  return nullptr;
}

/// Names of the options, in their order.
template <class Options>
std::vector<std::string_view> option_names() {
  std::vector<std::string_view> names;
  for (const Option<Options>& option : options_of<Options>()) names.push_back(option.info.name);
  return names;
}

/// Set an option from a text. Errors: usage (name, range and value).
template <class Options>
Result<void> set_option(const Option<Options>& option, std::string_view text, Options& options) {
  const Result<OptionValue> value = parse_option(option.info, text);
  if (!value) return named(option.info, value.error());
  const Result<void> valid = check_option(option.info, *value);
  if (!valid) return named(option.info, valid.error());
  option.set(options, *value);
  return {};
}

/// Check all values. Errors: usage (name, range and value) for the first value out of range.
template <class Options>
Result<void> check_options(const Options& options) {
  for (const Option<Options>& option : options_of<Options>()) {
    const Result<void> valid = check_option(option.info, option.get(options));
    if (!valid) return named(option.info, valid.error());
  }
  return {};
}

}  // namespace trivet

/// Declaration of an option for a field. The field's type determines kind, reading and writing.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include "engine/options/option.hpp"

namespace trivet::engine {

/// The shortest decimal that reads back as this float, so that 0.04F is 0.04.
double decimal_of(float field);

template <class Field>
struct FieldTraits;

template <>
struct FieldTraits<bool> {
  static constexpr OptionKind kKind = OptionKind::flag;
  static OptionValue get(bool field) { return field; }
  static void set(bool& field, const OptionValue& value) { field = std::get<bool>(value); }
};

template <std::floating_point Number>
struct FieldTraits<Number> {
  static constexpr OptionKind kKind = OptionKind::number;
  static OptionValue get(Number field) {
    if constexpr (std::is_same_v<Number, float>) return decimal_of(field);
    return static_cast<double>(field);
  }
  static void set(Number& field, const OptionValue& value) {
    field = static_cast<Number>(std::get<double>(value));
  }
};

/// Counts that a double and the field can both represent exactly.
template <std::unsigned_integral Number>
constexpr double kMostCount = std::min(static_cast<double>(std::numeric_limits<Number>::max()),
                                       9007199254740992.0);

template <std::unsigned_integral Number>
struct FieldTraits<Number> {
  static constexpr OptionKind kKind = OptionKind::count;
  static OptionValue get(Number field) { return static_cast<double>(field); }
  static void set(Number& field, const OptionValue& value) {
    field = static_cast<Number>(std::get<double>(value));
  }
};

template <>
struct FieldTraits<std::optional<float>> {
  static constexpr OptionKind kKind = OptionKind::number;
  static OptionValue get(const std::optional<float>& field) {
    return field ? OptionValue(decimal_of(*field)) : OptionValue(std::string("auto"));
  }
  static void set(std::optional<float>& field, const OptionValue& value) {
    field.reset();
    if (const double* const number = std::get_if<double>(&value))
      field = static_cast<float>(*number);
  }
};

template <class Enum>
requires std::is_enum_v<Enum>
struct FieldTraits<Enum> {
  static constexpr OptionKind kKind = OptionKind::choice;
  static OptionValue get(Enum field) { return std::string(choice_name(field)); }
  static void set(Enum& field, const OptionValue& value) {
    const std::span<const Choice> choices = choices_of<Enum>();
    for (std::size_t k = 0; k < choices.size(); ++k) {
      if (choices[k].name == std::get<std::string>(value)) field = static_cast<Enum>(k);
    }
  }
};

template <>
struct FieldTraits<std::vector<std::string>> {
  static constexpr OptionKind kKind = OptionKind::names;
  static OptionValue get(const std::vector<std::string>& field) { return field; }
  static void set(std::vector<std::string>& field, const OptionValue& value) {
    field = std::get<std::vector<std::string>>(value);
  }
};

/// path  a function that returns the field of the options
template <class Options, auto Path>
Option<Options> declare_option(OptionInfo info) {
  using Field = std::remove_cvref_t<decltype(Path(std::declval<Options&>()))>;
  using Traits = FieldTraits<Field>;
  info.kind = Traits::kKind;
  info.automatic = std::is_same_v<Field, std::optional<float>>;
  if constexpr (std::unsigned_integral<Field> && !std::is_same_v<Field, bool>) {
    info.range.low = std::max(info.range.low, 0.0);
    info.range.high = std::min(info.range.high, kMostCount<Field>);
  }
  if constexpr (std::is_enum_v<Field>) info.choices = choices_of<Field>();
  return {info, [](const Options& options) { return Traits::get(Path(options)); },
          [](Options& options, const OptionValue& value) { Traits::set(Path(options), value); }};
}

}  // namespace trivet::engine

/// The field that a path names, for declare_option.
#define TRIVET_FIELD(path) \
  [](auto& options) -> auto& { return options.path; }  // NOLINT: names of members have no brackets

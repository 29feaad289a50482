/// Adds options to the command line, from their declarations.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "engine/options/option.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace trivet::apps {

/// The value of one option on the command line.
struct GivenOption {
  std::string text;
  CLI::Option* option = nullptr;

  bool is_given() const;
};

/// Keyed by the names of options.
using GivenOptions = std::map<std::string_view, GivenOption>;

/// Adds --NAME to a command, with its help and a check of its value. `given` outlives the command.
///
/// usual  shown as the default
CLI::Option* add_option(CLI::App& command, const OptionInfo& info, const OptionValue& usual,
                        GivenOption& given);

/// Limits an option to these values, which its help lists.
CLI::Option* limit_to(CLI::Option* option, const std::vector<std::string>& names);

/// Adds all options that are for the command line.
template <class Options>
void add_options(CLI::App& command, GivenOptions& given) {
  for (const Option<Options>& option : options_of<Options>()) {
    if (option.info.place == OptionPlace::service_only) continue;
    add_option(command, option.info, option.get(Options{}), given[option.info.name]);
  }
}

/// Sets the given options. Errors: usage.
template <class Options>
Result<void> set_given(const GivenOptions& given, Options& options) {
  for (const auto& [name, what] : given) {
    if (!what.is_given()) continue;
    const Result<void> set = set_option(*find_option<Options>(name), what.text, options);
    if (!set) return set;
  }
  return {};
}

}  // namespace trivet::apps

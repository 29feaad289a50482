/// The options of the command line, from their declarations.
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

/// What a command line says of one option.
struct GivenOption {
  std::string text;
  CLI::Option* option = nullptr;

  bool is_given() const;
};

/// By the names of options.
using GivenOptions = std::map<std::string_view, GivenOption>;

/// Add --NAME to a command, with its help, and check what is given. `given` outlives the command.
///
/// usual  told as the default
CLI::Option* add_option(CLI::App& command, const OptionInfo& info, const OptionValue& usual,
                        GivenOption& given);

/// Let an option have these values only; its help tells them.
CLI::Option* limit_to(CLI::Option* option, const std::vector<std::string>& names);

/// Add all that are for the command line.
template <class Options>
void add_options(CLI::App& command, GivenOptions& given) {
  for (const Option<Options>& option : options_of<Options>()) {
    if (option.info.place == OptionPlace::service_only) continue;
    add_option(command, option.info, option.get(Options{}), given[option.info.name]);
  }
}

/// Set those that were given. Errors: usage.
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

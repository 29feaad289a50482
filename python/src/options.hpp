/// Converts keyword arguments to options, from the engine's lists of options.
#pragma once

#include <fmt/format.h>
#include <pybind11/pybind11.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "engine/options/option.hpp"
#include "python/src/call.hpp"
#include "storage/files/nearest_name.hpp"

namespace trivet::python {

/// The option's flag on the command line as a keyword: min_score stands for --min-score.
inline std::string keyword_of(std::string_view option) {
  std::string keyword(option);
  std::ranges::replace(keyword, '-', '_');
  return keyword;
}

/// Converts a value to the option's kind; None leaves it unset. Raises UsageError.
OptionValue value_of(const OptionInfo& info, const py::handle& value);
py::object object_of(const OptionValue& value);

/// Raises UsageError: an unknown keyword, or a value out of range.
template <class Options>
void set_options(const py::dict& keywords, Options& options) {
  for (const auto& [key, given] : keywords) {
    std::string name = py::cast<std::string>(key);
    std::ranges::replace(name, '_', '-');
    const Option<Options>* const option = find_option<Options>(name);
    if (!option || option->info.place == OptionPlace::service_only) {
      std::vector<std::string> keywords_known;
      for (const Option<Options>& one : options_of<Options>()) {
        if (one.info.place != OptionPlace::service_only)
          keywords_known.push_back(keyword_of(one.info.name));
      }
      const std::vector<std::string_view> known(keywords_known.begin(), keywords_known.end());
      raise({ErrorCode::usage, unknown_name(py::cast<std::string>(key), known)});
    }
    const OptionValue value = value_of(option->info, given);
    const Result<void> valid = check_option(option->info, value);
    if (!valid) raise(named(option->info, valid.error()));
    option->set(options, value);
  }
}

/// The available options as dictionaries: for each keyword its meaning, range and default.
template <class Options>
py::list describe_options() {
  py::list all;
  for (const Option<Options>& option : options_of<Options>()) {
    const OptionInfo& info = option.info;
    if (info.place == OptionPlace::service_only) continue;
    py::list choices;
    for (const Choice& choice : info.choices) choices.append(py::str(std::string(choice.name)));
    py::dict one;
    one["name"] = keyword_of(info.name);
    one["group"] = std::string(info.group);
    one["help"] = std::string(info.help);
    one["unit"] = std::string(info.unit);
    one["range"] = range_text(info);
    one["choices"] = choices;
    one["default"] = object_of(option.get(Options{}));
    all.append(one);
  }
  return all;
}

}  // namespace trivet::python

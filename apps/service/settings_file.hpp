/// Settings of a program that keeps running: from flags, or from a TOML file with the same names.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/common/result.hpp"

namespace CLI {
class App;
}

namespace trivet::apps::service {

struct Setting {
  std::string_view name;  ///< key in the file, and flag without its dashes
  std::string_view meaning;
  std::string text;  ///< default value
  /// Errors: usage (the name, what was expected, and the value).
  std::function<Result<void>(const std::string& value)> set;
  std::string_view argument{};  ///< name as a positional argument, such as LIBRARY; empty: a flag
  bool is_list = false;         ///< `set` adds a value; of flags, which may be repeated
  bool is_flag = false;         ///< values are true and false
};

/// A setting with any text.
Setting text_setting(std::string_view name, std::string_view meaning, std::string& value);

/// A switch that is off by default: a flag without a value, true or false in the file.
Setting flag_setting(std::string_view name, std::string_view meaning, bool& value);

/// A whole number.
Setting number_setting(std::string_view name, std::string_view meaning, std::uint64_t value,
                       std::uint64_t low, std::uint64_t high,
                       std::function<void(std::uint64_t)> store);
template <class Number>
Setting number_setting(std::string_view name, std::string_view meaning, Number& value,
                       std::uint64_t low, std::uint64_t high) {
  return number_setting(name, meaning, value, low, high,
                        [&value](std::uint64_t n) { value = static_cast<Number>(n); });
}

/// Settings given on the command line.
struct SettingArguments {
  std::string config;  ///< the file; empty: none
  bool check_config = false;
  std::map<std::string, std::vector<std::string>> values;  ///< keyed by the name of the setting
};

/// Adds a flag or a positional argument for each setting, --config and --check-config. `arguments`
/// outlives the app.
void add_settings(CLI::App& command, std::span<const Setting> settings,
                  SettingArguments& arguments);

/// All faults of settings, one line each.
using SettingFaults = std::vector<std::string>;

/// Sets the values of the file, overridden by those of flags. Errors: missing_input, io (the file).
Result<SettingFaults> set_values(std::span<const Setting> settings,
                                 const SettingArguments& arguments);

}  // namespace trivet::apps::service

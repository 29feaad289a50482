/// What a program that keeps running can be told: by flags, or in a TOML file with the same names.
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
  std::string_view name;  ///< the key in the file, and the flag without its dashes
  std::string_view meaning;
  std::string text;  ///< what it is when nobody sets it
  /// Errors: usage (its name, what was expected, and the value).
  std::function<Result<void>(const std::string& value)> set;
  std::string_view argument{};  ///< where it is none of the flags: its place, as LIBRARY
  bool is_list = false;         ///< `set` adds a value; of flags, which may be given again
  bool is_flag = false;         ///< its values are true and false
};

/// A text of any content.
Setting text_setting(std::string_view name, std::string_view meaning, std::string& value);

/// Off unless it is set: a flag without a value, true or false in the file.
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

/// What a command line says of settings.
struct SettingArguments {
  std::string config;  ///< the file; empty: none
  bool check_config = false;
  std::map<std::string, std::vector<std::string>> values;  ///< by the name of the setting
};

/// A flag or a place for each setting, --config and --check-config. `arguments` outlives the app.
void add_settings(CLI::App& command, std::span<const Setting> settings,
                  SettingArguments& arguments);

/// Everything that is wrong with settings, a line each.
using SettingFaults = std::vector<std::string>;

/// Set what the file says, and what flags say in its place. Errors: missing_input, io (the file).
Result<SettingFaults> set_values(std::span<const Setting> settings,
                                 const SettingArguments& arguments);

}  // namespace trivet::apps::service

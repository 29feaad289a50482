#include "apps/service/settings_file.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <filesystem>

#include "storage/files/file.hpp"
#include "storage/files/nearest_name.hpp"

namespace trivet::apps::service {
namespace {

constexpr std::uint64_t kMaxFileBytes = 1 << 20;

class SettingsReader {
 public:
  SettingsReader(std::span<const Setting> settings, const SettingArguments& arguments)
      : settings_(settings), arguments_(arguments) {}

  Result<void> read_file() {
    const Result<std::string> text = read_text_file(arguments_.config, kMaxFileBytes);
    if (!text) return text.error();
    const std::string file = std::filesystem::path(arguments_.config).filename().string();
    const auto where = [&](const toml::source_region& place) {
      return fmt::format("{}:{}: ", file, place.begin.line);
    };
    try {
      for (const auto& [key, node] : toml::parse(*text)) {
        if (!arguments_.values.contains(std::string(key.str())))
          set(where(node.source()), key.str(), node);
      }
    } catch (const toml::parse_error& error) {
      faults_.push_back(where(error.source()) + std::string(error.description()));
    }
    return {};
  }

  void read_flags() {
    for (const auto& [name, values] : arguments_.values) {
      const Setting& setting = *std::ranges::find(settings_, name, &Setting::name);
      for (const std::string& value : values)
        set(setting.argument.empty() ? "--" : "", setting, value);
    }
  }

  SettingFaults faults() { return std::move(faults_); }

 private:
  void set(const std::string& where, std::string_view name, const toml::node& node) {
    const auto setting = std::ranges::find(settings_, name, &Setting::name);
    if (setting == settings_.end()) {
      std::vector<std::string_view> names;
      for (const Setting& one : settings_) names.push_back(one.name);
      faults_.push_back(where + unknown_name(name, names));
    } else if (const toml::array* const list = node.as_array(); list && setting->is_list) {
      for (const toml::node& one : *list) set_value(where, *setting, one);
    } else {
      set_value(where, *setting, node);
    }
  }

  void set_value(const std::string& where, const Setting& setting, const toml::node& node) {
    if (const auto flag = node.value_exact<bool>(); setting.is_flag) {
      set(where, setting, !flag ? "" : *flag ? "true" : "false");
    } else if (const auto number = node.value_exact<std::int64_t>()) {
      set(where, setting, std::to_string(*number));
    } else if (const auto text = node.value_exact<std::string>()) {
      set(where, setting, *text);
    } else {
      faults_.push_back(
          fmt::format("{}{}: expected a whole number or a text", where, setting.name));
    }
  }

  void set(const std::string& where, const Setting& setting, const std::string& value) {
    if (const Result<void> done = setting.set(value); !done)
      faults_.push_back(where + done.error().message);
  }

  std::span<const Setting> settings_;
  const SettingArguments& arguments_;
  SettingFaults faults_;
};

}  // namespace

Setting text_setting(std::string_view name, std::string_view meaning, std::string& value) {
  return {name, meaning, value, [&value](const std::string& text) -> Result<void> {
            value = text;
            return {};
          }};
}

Setting flag_setting(std::string_view name, std::string_view meaning, bool& value) {
  const auto set = [name, &value](const std::string& text) -> Result<void> {
    if (text != "true" && text != "false")
      return Error{ErrorCode::usage, fmt::format("{}: expected true or false", name)};
    value = text == "true";
    return {};
  };
  return {name, meaning, "", set, "", false, true};
}

Setting number_setting(std::string_view name, std::string_view meaning, std::uint64_t value,
                       std::uint64_t low, std::uint64_t high,
                       std::function<void(std::uint64_t)> store) {
  return {name, meaning, std::to_string(value),
          [=, store = std::move(store)](const std::string& text) -> Result<void> {
            std::uint64_t number = 0;
            const char* const end = text.data() + text.size();
            const auto read = std::from_chars(text.data(), end, number);
            if (read.ec != std::errc() || read.ptr != end || number < low || number > high) {
              return Error{ErrorCode::usage,
                           fmt::format("{}: expected a whole number from {} to {}, found '{}'",
                                       name, low, high, text)};
            }
            store(number);
            return {};
          }};
}

void add_settings(CLI::App& command, std::span<const Setting> settings,
                  SettingArguments& arguments) {
  for (const Setting& setting : settings) {
    const std::string name(setting.name);
    const auto store_values = [&values = arguments.values, name](const CLI::results_t& given) {
      values[name] = given;
      return true;
    };
    if (setting.is_flag) {
      command.add_flag_callback(
          "--" + name, [&values = arguments.values, name] { values[name] = {"true"}; },
          std::string(setting.meaning));
      continue;
    }
    command
        .add_option(setting.argument.empty() ? "--" + name : std::string(setting.argument),
                    store_values, std::string(setting.meaning))
        ->type_name("TEXT")
        ->expected(1)
        ->multi_option_policy(setting.is_list ? CLI::MultiOptionPolicy::TakeAll
                                              : CLI::MultiOptionPolicy::Throw)
        ->allow_extra_args(false)
        ->default_str(setting.text);
  }
  command.add_option("--config", arguments.config,
                     "TOML file of these settings, as max-body-mb = 32; flags go before it");
  command.add_flag("--check-config", arguments.check_config,
                   "Say everything that is wrong with the settings, and end");
}

Result<SettingFaults> set_values(std::span<const Setting> settings,
                                 const SettingArguments& arguments) {
  SettingsReader reader(settings, arguments);
  if (!arguments.config.empty()) {
    TRIVET_TRY(reader.read_file());
  }
  reader.read_flags();
  return reader.faults();
}

}  // namespace trivet::apps::service

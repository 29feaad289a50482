/// Everything that an experiment may vary, by name.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "engine/evaluation/degrade_scene.hpp"
#include "engine/recognize.hpp"
#include "engine/simulation/render_scenes.hpp"
#include "engine/train.hpp"
#include "storage/result.hpp"

namespace trivet::apps::study {

/// What one scene of a study is made, trained for and recognized by.
struct StudySettings {
  ScanOptions scan{};
  DegradeOptions degrade{};
  TrainOptions train{};
  std::uint32_t num_others = 0;  ///< models of the library that lie in no scene
  RecognizeOptions recognize{};
};

/// Errors: usage (names the setting, its range and its value).
Result<void> validate(const StudySettings& settings);

using SettingValue = std::variant<bool, double, std::string, std::vector<std::string>>;

struct Setting {
  std::string_view name;   ///< STAGE.NAME, the name that of the command line's option
  std::string_view label;  ///< what it is, with its unit
  SettingValue (*get)(const StudySettings&);
  /// Errors: usage (what was expected instead of a value of this kind).
  Result<void> (*set)(StudySettings&, const SettingValue&);
};

/// By stage: scan, degrade, train, recognize.
std::span<const Setting> all_settings();

/// None of this name: null.
const Setting* find_setting(std::string_view name);

struct SettingChange {
  std::string name;  ///< of a setting that there is
  SettingValue value;
};

/// Errors: usage.
Result<void> change_settings(std::span<const SettingChange> changes, StudySettings& settings);

/// All settings of a stage with their values.
nlohmann::ordered_json stage_json(std::string_view stage, const StudySettings& settings);

/// As a person would write it: "0.04", "yes", "a, b", "none".
std::string value_text(const SettingValue& value);

}  // namespace trivet::apps::study

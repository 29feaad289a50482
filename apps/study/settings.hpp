/// Everything that an experiment may vary, by name.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/evaluation/degrade_scene.hpp"
#include "engine/options/option.hpp"
#include "engine/options/recognize_options.hpp"
#include "engine/options/train_options.hpp"
#include "engine/simulation/render_scenes.hpp"
#include "storage/common/result.hpp"

namespace trivet::apps::study {

/// The settings by which one scene of a study is made, trained for and recognized.
struct StudySettings {
  ScanOptions scan{};
  DegradeOptions degrade{};
  TrainOptions train{};
  std::uint32_t num_others = 0;  ///< models of the library that are in no scene
  RecognizeOptions recognize{};
};

/// Errors: usage (names the setting, its range and its value).
Result<void> validate(const StudySettings& settings);

/// An option of a stage.
struct Setting {
  std::string name;   ///< STAGE.NAME, where NAME is that of the option
  std::string label;  ///< description with its unit
  std::function<OptionValue(const StudySettings&)> get;
  /// Errors: usage (what was expected instead).
  std::function<Result<void>(StudySettings&, const OptionValue&)> set;
};

/// Ordered by stage: scan, degrade, train, recognize.
std::span<const Setting> all_settings();

/// Null: no setting of this name.
const Setting* find_setting(std::string_view name);

struct SettingChange {
  std::string name;  ///< name of an existing setting
  OptionValue value;
};

/// Errors: usage.
Result<void> change_settings(std::span<const SettingChange> changes, StudySettings& settings);

/// All settings of a stage with their values.
nlohmann::ordered_json stage_json(std::string_view stage, const StudySettings& settings);

}  // namespace trivet::apps::study

#include "apps/study/settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace trivet::apps::study {
namespace {

/// stage  part of the settings, by name and by member pointer
template <class Options>
void add_stage(std::string_view stage, Options StudySettings::*part, std::vector<Setting>& out) {
  for (const Option<Options>& option : options_of<Options>()) {
    if (option.info.place != OptionPlace::anywhere) continue;
    out.push_back(
        {fmt::format("{}.{}", stage, option.info.name), label_with_unit(option.info),
         [part, &option](const StudySettings& settings) { return option.get(settings.*part); },
         [part, &option](StudySettings& settings, const OptionValue& value) -> Result<void> {
           const Result<void> valid = check_option(option.info, value);
           if (valid) option.set(settings.*part, value);
           return valid;
         }});
  }
}

Setting other_models() {
  static constexpr OptionInfo kInfo{.name = "others",
                                    .group = {},
                                    .label = "other models in the library",
                                    .help = {},
                                    .range = {0, std::numeric_limits<std::uint32_t>::max()},
                                    .kind = OptionKind::count};
  return {"train.others", std::string(kInfo.label),
          [](const StudySettings& settings) {
            return OptionValue(static_cast<double>(settings.num_others));
          },
          [](StudySettings& settings, const OptionValue& value) -> Result<void> {
            const Result<void> valid = check_option(kInfo, value);
            if (valid) settings.num_others = static_cast<std::uint32_t>(std::get<double>(value));
            return valid;
          }};
}

std::vector<Setting> list_settings() {
  std::vector<Setting> out;
  add_stage("scan", &StudySettings::scan, out);
  add_stage("degrade", &StudySettings::degrade, out);
  out.push_back(other_models());
  add_stage("train", &StudySettings::train, out);
  add_stage("recognize", &StudySettings::recognize, out);
  return out;
}

}  // namespace

Result<void> validate(const StudySettings& settings) {
  for (const Result<void>& valid : {validate(settings.scan), validate(settings.degrade),
                                    validate(settings.train), validate(settings.recognize)}) {
    if (!valid) return valid;
  }
  return {};
}

std::span<const Setting> all_settings() {
  static const std::vector<Setting> settings = list_settings();
  return settings;
}

const Setting* find_setting(std::string_view name) {
  const std::span<const Setting> settings = all_settings();
  const auto found = std::ranges::find(settings, name, &Setting::name);
  return found == settings.end() ? nullptr : &*found;
}

Result<void> change_settings(std::span<const SettingChange> changes, StudySettings& settings) {
  for (const SettingChange& change : changes) {
    const Result<void> done = find_setting(change.name)->set(settings, change.value);
    if (!done)
      return Error{done.error().code, fmt::format("{}: {}", change.name, done.error().message)};
  }
  return {};
}

nlohmann::ordered_json stage_json(std::string_view stage, const StudySettings& settings) {
  nlohmann::ordered_json json;
  for (const Setting& known : all_settings()) {
    if (!known.name.starts_with(stage) || known.name[stage.size()] != '.') continue;
    std::visit([&](const auto& value) { json[known.name] = value; }, known.get(settings));
  }
  return json;
}

}  // namespace trivet::apps::study

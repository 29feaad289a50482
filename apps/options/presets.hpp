/// Named settings: fast, balanced, accurate.
#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>

#include "engine/recognize_options.hpp"
#include "engine/train_options.hpp"

namespace trivet::apps {

inline constexpr std::array<Choice, 3> kPresets{{{"fast"}, {"balanced"}, {"accurate"}}};
inline constexpr std::string_view kUsualPreset = "balanced";

/// group, what: heading and meaning of the option of a command.
constexpr OptionInfo preset_option(std::string_view group, std::string_view what) {
  return {.name = "preset",
          .group = group,
          .label = "preset",
          .help = what,
          .kind = OptionKind::choice,
          .choices = kPresets};
}

inline const std::map<std::string, TrainOptions, std::less<>>& train_presets() {
  static const std::map<std::string, TrainOptions, std::less<>> presets{
      {"fast", {.relative_step = 0.05F}}, {"balanced", {}}, {"accurate", {.relative_step = 0.03F}}};
  return presets;
}

inline const std::map<std::string, RecognizeOptions, std::less<>>& recognize_presets() {
  static const std::map<std::string, RecognizeOptions, std::less<>> presets{
      {"fast",
       {.vote = {.reference_share = 0.05F},
        .later = {.radius = 0.7F, .reference_share = 0.1F, .max_votes = 60000},
        .pose = {.max_clusters = 200, .max_refined = 20, .max_examined = 10}}},
      {"balanced", {}},
      {"accurate",
       {.vote = {.reference_share = 0.3F, .max_references = 10000},
        .later =
            {.radius = 0.7F, .reference_share = 0.4F, .max_references = 10000, .max_votes = 60000},
        .pose = {.max_clusters = 600, .max_refined = 160, .max_examined = 40}}}};
  return presets;
}

}  // namespace trivet::apps

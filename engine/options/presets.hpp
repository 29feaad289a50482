/// Named settings: fast, balanced, accurate.
#pragma once

#include <array>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/options/recognize_options.hpp"
#include "engine/options/train_options.hpp"
#include "storage/common/result.hpp"

namespace trivet {

/// The names of the presets.
inline constexpr std::array<Choice, 3> kPresets{{{"fast"}, {"balanced"}, {"accurate"}}};
/// The preset with the default values.
inline constexpr std::string_view kUsualPreset = "balanced";

/// The option that names a preset.
///
/// group, what   heading and meaning of the option of a command
constexpr OptionInfo preset_option(std::string_view group, std::string_view what) {
  return {.name = "preset",
          .group = group,
          .label = "preset",
          .help = what,
          .kind = OptionKind::choice,
          .choices = kPresets};
}

/// The presets of training, by name.
inline const std::map<std::string, TrainOptions, std::less<>>& train_presets() {
  static const std::map<std::string, TrainOptions, std::less<>> presets{
      {"fast", {.relative_step = 0.05F}}, {"balanced", {}}, {"accurate", {.relative_step = 0.03F}}};
  return presets;
}

/// The presets of recognition, by name.
inline const std::map<std::string, RecognizeOptions, std::less<>>& recognize_presets() {
  static const std::map<std::string, RecognizeOptions, std::less<>> presets{
      {"fast",
       {.vote = {.reference_share = 0.05F},
        .later = {.radius = 0.7F, .reference_share = 0.1F, .max_votes = 30000},
        .pose = {.max_clusters = 200, .max_refined = 20, .max_examined = 10}}},
      {"balanced", {}},
      {"accurate",
       {.budget = 5,
        .vote = {.reference_share = 0.3F, .max_references = 10000},
        .later =
            {.radius = 0.7F, .reference_share = 0.4F, .max_references = 10000, .max_votes = 60000},
        .pose = {.max_clusters = 600, .max_refined = 160, .max_examined = 40}}}};
  return presets;
}

/// Parse options given as names and texts, as in queries. One of them may be "preset"; the others
/// override it regardless of their order.
///
/// names_where   where all names are listed, for the error message
/// more          further names that the caller accepts, for the error message
/// Errors: usage (a name that is unknown or given twice; name, range and value).
Result<RecognizeOptions> parse_recognize_options(
    std::span<const std::pair<std::string_view, std::string_view>> texts,
    std::string_view names_where, std::vector<std::string_view> more = {});

}  // namespace trivet

#include "apps/study/settings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>

#include "apps/options/option_names.hpp"

namespace trivet::apps::study {
namespace {

Error wrong_kind(std::string_view expected, const SettingValue& found) {
  return {ErrorCode::usage, fmt::format("expected {}, found {}", expected, value_text(found))};
}

// From a field to a value.

SettingValue value_of(bool field) { return field; }
SettingValue value_of(std::uint32_t field) { return static_cast<double>(field); }
SettingValue value_of(std::uint64_t field) { return static_cast<double>(field); }
SettingValue value_of(double field) { return field; }
/// The shortest decimal that reads back as this float, so that 0.04F is 0.04.
SettingValue value_of(float field) {
  return std::isfinite(field) ? std::stod(fmt::format("{}", field)) : static_cast<double>(field);
}
SettingValue value_of(const std::optional<float>& field) {
  return field ? value_of(*field) : SettingValue(std::string("auto"));
}
template <class Enum, std::enable_if_t<std::is_enum_v<Enum>, int> = 0>
SettingValue value_of(Enum field) {
  return option_name(field);
}
SettingValue value_of(const ImprovementSet& field) {
  std::vector<std::string> names;
  for (const ImprovementName& known : kImprovements) {
    if (field.contains(known.improvement)) names.emplace_back(known.name);
  }
  return names;
}

// From a value to a field.

Result<void> assign(const SettingValue& value, bool& field) {
  if (!std::holds_alternative<bool>(value)) return wrong_kind("true or false", value);
  field = std::get<bool>(value);
  return {};
}
Result<void> assign(const SettingValue& value, double& field) {
  if (!std::holds_alternative<double>(value)) return wrong_kind("a number", value);
  field = std::get<double>(value);
  return {};
}
Result<void> assign(const SettingValue& value, float& field) {
  double number = 0;
  if (const Result<void> done = assign(value, number); !done) return done;
  field = static_cast<float>(number);
  return {};
}
template <class Integer, std::enable_if_t<std::is_unsigned_v<Integer>, int> = 0>
Result<void> assign(const SettingValue& value, Integer& field) {
  const double* const number = std::get_if<double>(&value);
  const auto most = static_cast<double>(std::numeric_limits<std::uint32_t>::max());
  if (!number || !(*number >= 0 && *number <= most) || std::floor(*number) != *number)
    return wrong_kind("a whole number from 0 on", value);
  field = static_cast<Integer>(*number);
  return {};
}
Result<void> assign(const SettingValue& value, std::optional<float>& field) {
  if (value == SettingValue(std::string("auto"))) {
    field.reset();
    return {};
  }
  if (!std::holds_alternative<double>(value)) return wrong_kind("a number or \"auto\"", value);
  field = static_cast<float>(std::get<double>(value));
  return {};
}
template <class Enum, std::enable_if_t<std::is_enum_v<Enum>, int> = 0>
Result<void> assign(const SettingValue& value, Enum& field) {
  const OptionNames<Enum>& names = option_names<Enum>();
  const std::string* const name = std::get_if<std::string>(&value);
  if (!name || !names.contains(*name)) {
    std::vector<std::string> known;
    for (const auto& entry : names) known.push_back(entry.first);
    return wrong_kind(fmt::format("one of {}", fmt::join(known, ", ")), value);
  }
  field = names.at(*name);
  return {};
}
Result<void> assign(const SettingValue& value, ImprovementSet& field) {
  const auto* const names = std::get_if<std::vector<std::string>>(&value);
  if (!names) return wrong_kind("a list of improvements", value);
  field = {};
  for (const std::string& name : *names) {
    const auto known = std::ranges::find(kImprovements, name, &ImprovementName::name);
    if (known == kImprovements.end())
      return wrong_kind("improvements by their names, as `trivet evaluate --help` has them", value);
    field.insert(known->improvement);
  }
  return {};
}

/// Field: a function that gives the field of the settings.
template <auto Field>
constexpr Setting setting(std::string_view name, std::string_view label) {
  return {name, label, [](const StudySettings& settings) { return value_of(Field(settings)); },
          [](StudySettings& settings, const SettingValue& value) {
            return assign(value, Field(settings));
          }};
}

#define FIELD(path) \
  [](auto& s) -> auto& { return s.path; }

constexpr std::array kSettings{
    setting<FIELD(scan.num_scenes)>("scan.scenes", "scenes"),
    setting<FIELD(scan.num_instances)>("scan.instances", "objects of a scene"),
    setting<FIELD(scan.of_a_kind)>("scan.of-a-kind", "copies of a model side by side"),
    setting<FIELD(scan.num_clutter)>("scan.clutter", "unknown objects of a scene"),
    setting<FIELD(scan.seed)>("scan.seed", "seed of the scenes"),
    setting<FIELD(scan.deviation)>("scan.deviation",
                                   "deviation of the objects from their models [diameters]"),
    setting<FIELD(scan.bin)>("scan.bin", "in an open box"),
    setting<FIELD(scan.walls)>("scan.walls", "walls behind the objects"),
    setting<FIELD(scan.sensor.sensor)>("scan.sensor", "sensor"),
    setting<FIELD(scan.sensor.noise)>("scan.noise", "noise of the sensor, in its own"),
    setting<FIELD(scan.sensor.disparity_step_pixel)>("scan.disparity-step",
                                                     "steps of disparity [pixel]"),
    setting<FIELD(degrade.scattered)>("degrade.scattered", "without the pixel grid"),
    setting<FIELD(degrade.noise)>("degrade.noise", "Gaussian noise [resolution of the scan]"),
    setting<FIELD(degrade.noise_diameters)>("degrade.noise-diameters",
                                            "Gaussian noise [mean diameter]"),
    setting<FIELD(degrade.ray_noise)>("degrade.ray-noise",
                                      "noise along the viewing ray [resolution of the scan]"),
    setting<FIELD(degrade.shot_noise)>("degrade.shot-noise", "share of stray points"),
    setting<FIELD(degrade.keep)>("degrade.keep", "share of the points that is kept"),
    setting<FIELD(degrade.subsampler)>("degrade.subsampler", "subsampler"),
    setting<FIELD(degrade.cell)>("degrade.cell", "cell of the subsampler [mean diameter]"),
    setting<FIELD(num_others)>("train.others", "other models in the library"),
    setting<FIELD(train.relative_step)>("train.relative-step", "sampling rate tau_d [diameter]"),
    setting<FIELD(train.reference_spacing)>("train.reference-spacing",
                                            "spacing of the model's reference points [steps]"),
    setting<FIELD(train.num_angle_bins)>("train.angle-bins", "bins over 180° of a pair's angles"),
    setting<FIELD(train.num_components)>("train.components", "principal components"),
    setting<FIELD(train.component_energy)>("train.component-energy",
                                           "share of the variance in the components"),
    setting<FIELD(recognize.min_score)>("recognize.min-score", "least score"),
    setting<FIELD(recognize.require_pose)>("recognize.require-pose",
                                           "least score held against the very pose"),
    setting<FIELD(recognize.max_instances)>("recognize.max-instances", "instances of a model"),
    setting<FIELD(recognize.normal_window)>("recognize.normal-window",
                                            "radius of the normals' windows [spacing]"),
    setting<FIELD(recognize.vote.radius)>("recognize.radius", "radius of pairs [diameter]"),
    setting<FIELD(recognize.vote.reference_share)>("recognize.reference-share",
                                                   "share of points that are references"),
    setting<FIELD(recognize.vote.neighbor_share)>("recognize.neighbor-share",
                                                  "share of a bin that votes for the next, too"),
    setting<FIELD(recognize.vote.max_votes)>("recognize.max-votes",
                                             "votes of a reference point for a model"),
    setting<FIELD(recognize.pose.cluster_rotation_deg)>("recognize.cluster-rotation",
                                                        "rotation threshold of clustering [°]"),
    setting<FIELD(recognize.pose.cluster_translation)>(
        "recognize.cluster-translation", "translation threshold of clustering [diameter]"),
    setting<FIELD(recognize.pose.max_clusters)>("recognize.max-clusters", "clusters of a model"),
    setting<FIELD(recognize.pose.min_cluster_share)>("recognize.min-cluster-share",
                                                     "least share of the best cluster's votes"),
    setting<FIELD(recognize.pose.rounds)>("recognize.rounds", "rounds of searching"),
    setting<FIELD(recognize.match.detector)>("recognize.keypoints", "keypoint detector"),
    setting<FIELD(recognize.match.spacing)>("recognize.keypoint-spacing",
                                            "spacing of keypoints [1/80 diameter]"),
    setting<FIELD(recognize.match.limits.max_lean)>("recognize.max-lean",
                                                    "lean of a keypoint's surface [radius]"),
    setting<FIELD(recognize.match.num_neighbors)>("recognize.neighbors",
                                                  "features that each is matched with"),
    setting<FIELD(recognize.match.max_distance)>("recognize.max-distance",
                                                 "largest distance of matches"),
    setting<FIELD(recognize.match.max_ratio)>("recognize.max-ratio",
                                              "matching threshold tau (NNDR)"),
    setting<FIELD(recognize.match.weigh_by_ratio)>("recognize.weigh-by-ratio",
                                                   "matches weighed by their ratio"),
    setting<FIELD(recognize.match.grouping)>("recognize.grouping", "grouping of matches"),
    setting<FIELD(recognize.ablate)>("recognize.ablate", "left out"),
};

#undef FIELD

}  // namespace

Result<void> validate(const StudySettings& settings) {
  for (const Result<void>& valid : {validate(settings.scan), validate(settings.degrade),
                                    validate(settings.train), validate(settings.recognize)}) {
    if (!valid) return valid;
  }
  return {};
}

std::span<const Setting> all_settings() { return kSettings; }

const Setting* find_setting(std::string_view name) {
  const auto found = std::ranges::find(kSettings, name, &Setting::name);
  return found == kSettings.end() ? nullptr : &*found;
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
  for (const Setting& known : kSettings) {
    if (!known.name.starts_with(stage) || known.name[stage.size()] != '.') continue;
    std::visit([&](const auto& value) { json[std::string(known.name)] = value; },
               known.get(settings));
  }
  return json;
}

std::string value_text(const SettingValue& value) {
  if (const bool* const flag = std::get_if<bool>(&value)) return *flag ? "yes" : "no";
  if (const double* const number = std::get_if<double>(&value)) return fmt::format("{:g}", *number);
  if (const std::string* const text = std::get_if<std::string>(&value)) return *text;
  const auto& list = std::get<std::vector<std::string>>(value);
  return list.empty() ? "none" : fmt::format("{}", fmt::join(list, ", "));
}

}  // namespace trivet::apps::study

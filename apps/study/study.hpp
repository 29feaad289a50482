/// A study as declared by its configuration.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/study/settings.hpp"
#include "engine/options/method.hpp"

namespace trivet::apps::study {

/// Models of one kind: files, or generated parts.
struct ModelGroup {
  std::string name;
  std::vector<std::string> files;  ///< arguments of collect_models
  std::uint32_t num_parts = 0;     ///< number of generated parts
  std::vector<std::string> families;
  ScanModelOptions options{};
};

/// Scenes of one kind: scanned for the study, or those of a manifest.
struct SceneGroup {
  std::string name, title;
  std::vector<std::size_t> models;  ///< groups with models in the scenes
  std::vector<std::size_t> others;  ///< groups from which `train.others` adds models
  std::filesystem::path manifest;   ///< empty: scanned
  std::vector<SettingChange> changes;
};

struct Variant {
  std::string name;
  std::optional<double> number;  ///< value of a numeric setting
  std::vector<SettingChange> changes;
};

/// Which detections count as reported.
enum class Threshold : std::uint8_t {
  setting,  ///< those with at least recognize.min-score
  /// The threshold of each variant that gives its best F1, for scores of different meanings.
  best_f1,
};

/// The horizontal axis of the curves.
enum class Curve : std::uint8_t { variants, occlusion, clutter };

/// The variant with which named variants are compared.
enum class Against : std::uint8_t {
  usual,     ///< the variant that changes nothing
  previous,  ///< the previous variant: steps that build on one another
};

struct Experiment {
  std::string name, title, about;
  std::vector<std::size_t> scenes;
  std::vector<Method> methods;
  std::string vary;  ///< a setting; empty: the variants have names
  std::vector<Variant> variants;
  std::vector<SettingChange> changes;
  std::uint32_t repetitions = 1;  ///< each with other scenes
  Threshold threshold = Threshold::setting;
  Curve curve = Curve::variants;
  Against against = Against::usual;
};

struct Study {
  std::string title, about;
  std::uint64_t seed = 1;
  std::uint32_t num_pictures = 3;  ///< scenes shown in the report
  std::vector<ModelGroup> models;
  std::vector<SceneGroup> scenes;
  std::vector<Experiment> experiments;
  std::string text;  ///< text of the whole configuration
};

/// The settings of one variant: the defaults, changed by the group of scenes, the experiment, the
/// method and the variant, in this order. Errors: usage.
Result<StudySettings> settings_of(const Study& study, const Experiment& experiment,
                                  const SceneGroup& scenes, Method method, const Variant& variant);

/// Reads a configuration (TOML). Its paths are relative to it.
/// Errors: missing_input, io, bad_data: every fault with its line, what was expected and found.
Result<Study> read_study(const std::filesystem::path& file);

}  // namespace trivet::apps::study

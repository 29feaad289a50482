/// What a study compares, as its configuration declares it.
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

/// Models of one kind: files, or parts made to order.
struct ModelGroup {
  std::string name;
  std::vector<std::string> files;  ///< as collect_models takes them
  std::uint32_t num_parts = 0;     ///< made parts beside them
  std::vector<std::string> families;
  ScanModelOptions options{};
};

/// Scenes of one kind: scanned for the study, or those of a manifest.
struct SceneGroup {
  std::string name, title;
  std::vector<std::size_t> models;  ///< groups that lie in the scenes
  std::vector<std::size_t> others;  ///< groups that `train.others` takes models from
  std::filesystem::path manifest;   ///< empty: scanned
  std::vector<SettingChange> changes;
};

struct Variant {
  std::string name;
  std::optional<double> number;  ///< of a numeric setting
  std::vector<SettingChange> changes;
};

/// What detections count as reported.
enum class Threshold : std::uint8_t {
  setting,  ///< those from recognize.min-score on
  best_f1,  ///< each variant its own, where its F1 is the best: scores that mean different things
};

/// What its curves run over.
enum class Curve : std::uint8_t { variants, occlusion, clutter };

/// What named variants are compared with.
enum class Against : std::uint8_t {
  usual,     ///< the variant that changes nothing
  previous,  ///< each with the one before: steps that build on one another
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
  std::uint32_t num_pictures = 3;  ///< scenes that the report shows
  std::vector<ModelGroup> models;
  std::vector<SceneGroup> scenes;
  std::vector<Experiment> experiments;
  std::string text;  ///< the whole configuration
};

/// The settings of one variant: the defaults, changed by the group of scenes, the experiment, the
/// method and the variant, in this order. Errors: usage.
Result<StudySettings> settings_of(const Study& study, const Experiment& experiment,
                                  const SceneGroup& scenes, Method method, const Variant& variant);

/// Read a configuration (TOML). Its paths are relative to it.
/// Errors: missing_input, io, bad_data: every fault with its line, what was expected and found.
Result<Study> read_study(const std::filesystem::path& file);

}  // namespace trivet::apps::study

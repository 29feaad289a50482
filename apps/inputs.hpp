/// From the names on the command line to models and scenes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/recognise.hpp"
#include "engine/train.hpp"
#include "storage/library.hpp"

namespace trivet::apps {

/// "m" or "mm". Pre: checked by the command line.
LengthUnit parse_unit(const std::string& text);
const char* unit_name(LengthUnit unit);

struct ModelInputs {
  std::vector<ModelSource> sources;
  std::optional<LengthUnit> unit;  ///< of the manifests among them
};

/// Each argument is a file, NAME=FILE, a folder (every readable file in it, by name) or a manifest.
/// Errors: missing_input, bad_data, usage (two models of one name).
Result<ModelInputs> collect_models(const std::vector<std::string>& arguments);

/// The unit of the models: what their manifests say, else `given`, else metres. Errors: usage (they
/// disagree).
Result<LengthUnit> choose_unit(const ModelInputs& inputs, const std::string& given);

struct SceneArguments {
  std::vector<std::string> scenes;  ///< files, folders or manifests
  std::string camera;               ///< file, or empty
  std::vector<float> viewpoint;     ///< empty or three numbers
  std::optional<LengthUnit> unit;   ///< of the scenes; absent: the library's
};

/// Errors: missing_input, bad_data, usage (a depth image without a camera).
Result<std::vector<SceneInput>> collect_scenes(const SceneArguments& arguments,
                                               LengthUnit library_unit);

}  // namespace trivet::apps

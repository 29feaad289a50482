/// Converts arguments of the command line to models and scenes.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/recognition/recognize.hpp"
#include "engine/training/train.hpp"
#include "storage/datasets/manifest.hpp"
#include "storage/library/library.hpp"

namespace trivet::apps {

/// Parses "m" or "mm". Pre: checked by the command line.
LengthUnit parse_unit(const std::string& text);

/// Whether an argument lists models and scenes: a manifest or a BOP data set.
bool is_listing(const std::string& argument);
/// Reads its models and scenes. Errors: those of read_manifest and read_bop.
Result<Manifest> read_listing(const std::string& argument);

struct ModelInputs {
  std::vector<ModelSource> sources;
  std::optional<LengthUnit> unit;     ///< unit of the manifests and BOP data sets
  std::vector<std::string> notes;     ///< messages about names derived from file names
  std::vector<std::string> left_out;  ///< paths in the given folders that were not read
};

/// Each argument is a file, NAME=FILE, a folder, a manifest or the folder of a BOP data set. A
/// folder stands for every readable file in it, by name, except names that begin with a dot and
/// files in subfolders. Models of files are named by model_name_of.
/// Errors: missing_input, bad_data, usage (two models of one name, or an invalid name).
Result<ModelInputs> collect_models(const std::vector<std::string>& arguments);

/// A message for each folder with ignored files: "parts: left out, as nothing that can be read:
/// clip.3mf, hook.igs; folders in it are not searched: sub".
std::vector<std::string> left_out_words(const std::vector<std::string>& left_out);

/// The unit of the models: that of their manifests, else `given`, else that of the library to which
/// they are added, else meters.
/// Errors: usage (they disagree; a library has one unit).
///
/// library  the library of the file that is updated; absent: a new one
Result<LengthUnit> choose_unit(const ModelInputs& inputs, const std::string& given,
                               std::optional<LengthUnit> library = {});

/// The unit as above, for a library file that is updated if it exists and can be read.
///
/// prune  none of its models stay, so that another unit is allowed
Result<LengthUnit> choose_unit_into(const std::string& library_file, const ModelInputs& inputs,
                                    const std::string& given, bool prune);

struct SceneArguments {
  std::vector<std::string> scenes;  ///< files, folders, manifests, BOP data sets, "-" at most once
  std::string format;               ///< format of files and standard input; empty: detected
  std::string camera;               ///< file, or empty
  std::optional<int> image_id;  ///< image in the file; absent: the number in the scene's file name
  std::vector<double> viewpoint;   ///< empty or three numbers
  std::optional<LengthUnit> unit;  ///< unit of the scenes; absent: the library's
};

struct SceneInputs {
  std::vector<SceneInput> sources;
  /// Ids in BOP, one per source; -1 without an id.
  struct Ids {
    int scene = -1, image = -1;
  };
  std::vector<Ids> ids;
  std::map<std::string, int> object_ids;  ///< ids in BOP, keyed by model name
  std::vector<std::string> left_out;      ///< paths in the given folders that were not read
};

/// The unit of a scene's file, and of all reported lengths of the scene.
LengthUnit scene_unit(const SceneInput& scene, LengthUnit library_unit);

/// Collects the scenes. "-" stands for standard input, which is read to its end.
/// Errors: missing_input, bad_data, io, usage (a depth image without a camera; standard input
/// twice, or with a format that cannot be detected).
Result<SceneInputs> collect_scenes(const SceneArguments& arguments, LengthUnit library_unit);

}  // namespace trivet::apps

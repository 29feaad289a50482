/// From the names on the command line to models and scenes.
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

/// "m" or "mm". Pre: checked by the command line.
LengthUnit parse_unit(const std::string& text);

/// Whether an argument lists models and scenes: a manifest or a BOP data set.
bool is_listing(const std::string& argument);
/// Its models and scenes. Errors: those of read_manifest and read_bop.
Result<Manifest> read_listing(const std::string& argument);

struct ModelInputs {
  std::vector<ModelSource> sources;
  std::optional<LengthUnit> unit;     ///< of the manifests and BOP data sets among them
  std::vector<std::string> notes;     ///< names that were made from those of files, for a person
  std::vector<std::string> left_out;  ///< what folders hold that is no model to read, as paths
};

/// Each argument is a file, NAME=FILE, a folder (every readable file in it, by name; none that begins
/// with a dot, and none of folders in it), a manifest or the folder of a BOP data set. A file's model
/// is called as model_name_of says.
/// Errors: missing_input, bad_data, usage (two models of one name, or a name that is none).
Result<ModelInputs> collect_models(const std::vector<std::string>& arguments);

/// What to tell of them, a sentence a folder: "parts: left out, as nothing that can be read:
/// clip.3mf, hook.igs; folders in it are not searched: sub".
std::vector<std::string> left_out_words(const std::vector<std::string>& left_out);

/// The unit of the models: what their manifests say, else `given`, else that of the library that they
/// go into, else meters. Errors: usage (they disagree; a library has one unit).
///
/// library  of the file that is brought up to date; absent: a new one
Result<LengthUnit> choose_unit(const ModelInputs& inputs, const std::string& given,
                               std::optional<LengthUnit> library = {});

/// The same for a library file that is brought up to date, where there is one that can be read.
///
/// prune  nothing of it stays, so that another unit may be asked for
Result<LengthUnit> choose_unit_into(const std::string& library_file, const ModelInputs& inputs,
                                    const std::string& given, bool prune);

struct SceneArguments {
  std::vector<std::string> scenes;  ///< files, folders, manifests, BOP data sets, once "-"
  std::string format;               ///< of files and of standard input; empty: as they tell
  std::string camera;               ///< file, or empty
  std::optional<int> image_id;      ///< in it; absent: the number that is the scene's file name
  std::vector<double> viewpoint;    ///< empty or three numbers
  std::optional<LengthUnit> unit;   ///< of the scenes; absent: the library's
};

struct SceneInputs {
  std::vector<SceneInput> sources;
  /// What BOP calls them; one a source, -1 where there are none.
  struct Ids {
    int scene = -1, image = -1;
  };
  std::vector<Ids> ids;
  std::map<std::string, int> object_ids;  ///< of BOP, by the model's name
  std::vector<std::string> left_out;      ///< what folders hold that is no scan to read, as paths
};

/// Of a scene's file and of all lengths that are told of it.
LengthUnit scene_unit(const SceneInput& scene, LengthUnit library_unit);

/// "-" stands for standard input, which is read to its end.
/// Errors: missing_input, bad_data, io, usage (a depth image without a camera; standard input twice,
/// or of a format that its bytes do not tell).
Result<SceneInputs> collect_scenes(const SceneArguments& arguments, LengthUnit library_unit);

}  // namespace trivet::apps
